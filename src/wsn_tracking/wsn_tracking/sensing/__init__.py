"""From radio messages to epochs: values, trigger, epoch assembly."""
