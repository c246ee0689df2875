"""The codes that the project is measured against, one file each; `peers()` of a file returns what
it offers or raises PeerAbsent.
"""
