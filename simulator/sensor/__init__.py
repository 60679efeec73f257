"""A mounted skin in time: contacts in, readings of its meter out, step by step."""
