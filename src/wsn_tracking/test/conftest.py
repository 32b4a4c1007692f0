"""Drawn inputs have no deadline: how long one takes says how busy the machine is, not whether the program is right."""

from hypothesis import settings

settings.register_profile('patient', settings(), deadline=None)
settings.load_profile('patient')
