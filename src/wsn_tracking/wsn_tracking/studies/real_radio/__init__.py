"""What real radio needs: public recordings through system A, one switch after the other."""
