"""Spectra in the lines above the numbers: as what the numbers are, which is refused, or
as what a motion was made for, as in `spectrum-compatible accelerogram`.
"""

import re

from .headings import others_in

_SPECTRUM = re.compile(r"spe[ck]tr|spettr|\bresp\w*\W+spec\b|\bspec\W+acc")
# a line that begins with the short name of a spectrum, as SA TIME SERIES
_SHORT = re.compile(
    r"\W*(?:[pr]?sa|s[vde]|rs)\W*(?:$|\b(?:time|history|series|in|values?|data|g)\b)"
)
# what a motion is made for, as in `spectrum-compatible` or `matched to the spectrum`
_COMPATIBLE = re.compile(
    r"\b(?:response |design |target |elastic |code )*\w*(?:spe[ck]tr|spettr)\w*[\s-]*"
    r"(?:[ck]ompatib|match|fitted|consistent)\w*"
)
_AIM = re.compile(
    r"\b(?:for|from|to|with|con|mit|zu|avec) (?:[^\s,;]+ ){0,5}?"
    r"(?:\w*(?:spe[ck]tr|spettr)\w*|uhs|\w*intensity|rotd\d+)"
)
# what a spectrum may be the aim of
_AIMED = re.compile(
    r"accelerogram|\bmotion|\btime.?(?:history|series)|\brecord|\bsignal|[ck]ompatib"
    r"|\bmatch|\bfitted|\bscaled|\badjusted|\bconsistent"
)
_IN_TIME = re.compile(
    r"accelerogram|\bacceleration(?! (?:response|design|\w*spe[ck]tr))|\bmotion"
    r"|\btime.?(?:history|series)"
)
_MADE = re.compile(r"artificial|synthetic|simulated|generated")


def names_spectrum(said: str) -> bool:
    """True if a line, without the aim of its motion, names a spectrum, an intensity or
    a rotation.
    """
    return _SPECTRUM.search(said) is not None or any(
        "spectrum" in x or "intensity" in x or x == "rotation" for x in others_in(said)
    )


def begins_with_spectrum(text: str) -> bool:
    """True for a line that begins with the short name of a spectrum, as SA TIME
    SERIES.
    """
    return _SHORT.match(text) is not None


def without_aim(text: str) -> str:
    """Return a line without the spectrum or intensity that its motion was made for,
    and without the word of a response in time.
    """
    said = re.sub(r"\bresponse (?=time.?(?:history|series))", "", text)
    said = _COMPATIBLE.sub(" compatible ", said)
    aim = _AIM.search(said)
    if aim is not None and _AIMED.search(said[: aim.start()]):
        said = said[: aim.start()] + said[aim.end() :]
    clauses = re.split(r"[,;()]", said)
    made = [x for x in clauses if _MADE.search(x) and _IN_TIME.search(x)]
    return next((x for x in made if not _SPECTRUM.search(x)), said)
