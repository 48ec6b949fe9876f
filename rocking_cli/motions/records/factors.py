"""Factors that a line or a heading states: `scale factor: 0.01`, `x 9.81`, `g/10`, `in
0.1 g`.

It is not known whether the numbers have the factor already, so that its file is
refused. A factor of 1 is none.
"""

import re
import unicodedata

from .units import dimension_of, plain

_NUM = r"([-+]?(?:\d+\.?\d*|\.\d+)(?:[ed][-+]?\d+|\^?-\d+)?)"
_SCALING = (
    r"(?<!full )\bscal(?:e|es|ed|ing)(?![a-eg-z])(?! to\b)|\b(?:multipl|divid)\w+|"
    r"\b(?:conversion|calibration|amplification|magnification)\b|\bcalib\b|\bcoef\w*|"
    r"\bcounts? (?:to (?:g|gal|m/s2|cm/s2)\b|=)|\bfactor\b|\bgain\b|\blsb\b|"
    r"\bsensitivity\b|\bamplified\b|\btimes(?= \d)|\bsf\b(?=\s*[:=]|\s*\d*\.\d)|"
    r"\b(?:faktor|massstab|skalierung|facteur|echelle|escala|fattore|scala|olcek|"
    r"carpan|katsayi\w*)\b|系数|比例|倍率"
)
# words that may stand between a word of `_SCALING` and its number
_ASIDE = (
    r"(?:[ _-]?(?:factor|constant|faktor|by|with|of|is|the|all|values?|data|samples?|"
    r"ordinates?|accelerations?|katsayi\w*|de|di|d?echelle|escala|scala))*"
)
_SCALED = re.compile(
    rf"(?:{_SCALING}){_ASIDE}\s*(?:[\[(][^\])]*[\])])?\s*[:=,;\t]?\s*{_NUM}(?![/\d])"
    r"([^,;\s]*(?:\s*(?:m?g|gal|c?m/s2|m?v)\b)?)"
)
_NORMALISED = re.compile(
    r"\bnormali[sz]ed\b|\bnormiert\b|\bnormalizad[oa]\b|\bnormalizzat[oa]\b"
)
_PER = re.compile(
    r"\b(?:counts?|volts?|mv|v) ?(?:per|/) ?(?:m?g|gal|cm/s2|m/s2)\b\s*[:=]?\s*\d"
)
_TIMES = re.compile(
    r"(?:(?<![a-zA-Z\d])(?<!\d"
    r" )x|×|(?<!\*)\*(?!\*))\s*(\d+(?:\.\d*)?(?:e[-+]?\d+|\^\d+|\^?-\d+)?)"
    r"(?=\s*(?:$|[\[\](),;=]|%?g\b|gals?\b|c?m/s))",
    re.IGNORECASE,
)
_OVER = re.compile(
    r"(?:\b(?:acc\w*|gal|data|values?)|(?:^|[\[(]|\b(?:in|of|units?)\W+)(?:a|ag|g))"
    r"\s*/\s*(\d+(?:\.\d*)?)\b(?![/.]\w)"
)
_PARTS = re.compile(r"\b(?:tenths|hundredths|thousandths|multiples)\s+of\b")
_IN_PARTS = re.compile(
    rf"\b(?:in|units?(?: of)?)\s*[:=]?\s*(?:1/\d+|{_NUM})\s*([a-z%][^\s,;)\]]*)"
)


def states_factor(words: str) -> bool:
    """True if a line states a factor other than 1."""
    text = plain(words)
    if _NORMALISED.search(text) or _PARTS.search(text) or _PER.search(text):
        return True
    # `scale factor: 1` has no unit behind its 1, `1 LSB = 1 mg` has
    if any(found[2] or not _is_one(found[1]) for found in _SCALED.finditer(text)):
        return True
    digits = unicodedata.normalize("NFKC", words).replace("−", "-")
    signs = [*_TIMES.finditer(digits), *_OVER.finditer(text)]
    if any(not _is_one(found[1]) for found in signs):
        return True
    parts = [
        x for x in _IN_PARTS.finditer(text) if dimension_of(x[2]) == "acceleration"
    ]
    return any(x[1] is None or not _is_one(x[1]) for x in parts)


def _is_one(number: str) -> bool:
    try:
        return float(number.replace("d", "e")) == 1.0
    except ValueError:  # 10^-3
        return False
