"""Speed against goals and against other libraries."""
