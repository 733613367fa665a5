"""Record what the MTConnect agent of a machine tells into a file.

The recording ends after --duration, when the program is completed (--until-completed,
--next-run), or when it is interrupted; the file is complete up to there.
"""
