"""The configuration: its declaration, its reading with every problem at once, its checks, and what
each stage sees of it.
"""
