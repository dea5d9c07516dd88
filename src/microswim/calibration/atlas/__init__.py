"""The atlas: corrections of the surrogate over the whole design space, made once and shipped.

`coordinates` says where a design lies, `atlas` evaluates, `near` says how far off, `campaign`
solves the designs and `fit` makes an atlas of them; `choice` takes the model that serves a swimmer.
"""
