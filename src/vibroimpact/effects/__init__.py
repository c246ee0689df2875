"""The catalogue of effects that a model may lack, one file each; registry.py lists them."""
