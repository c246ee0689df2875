"""The stages of a study and of a measured campaign: each reads files, calls the library and writes
files.

`make(given, made, params)` of a module takes the paths that it reads and writes, and its settings,
as attributes of three objects. `params.config` holds the keys of the configuration that
config/stage_keys.py lists for the stage, `params.library` the digest of its source. It may return
the Stopwatch of its parts.
"""
