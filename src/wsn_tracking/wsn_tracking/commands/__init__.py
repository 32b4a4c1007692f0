"""The commands of `wsn-tracking`, one module each, in the order of --help.

A command module offers `add(commands)`, which describes it; what it needs beyond words is imported when it runs.
"""
