"""How figures show outcomes: colours, and signs in maps of characters."""

from ...dynamics.outcome import Difference, Outcome

# those of Okabe and Ito, which colour-blind people can tell apart
COLOURS = {
    Outcome.NOT_COMPUTED: "#DDDDDD",
    Outcome.NO_UPLIFT: "#FFFFFF",
    Outcome.ROCKED: "#BFDDEB",
    Outcome.OVERTURNED_NO_IMPACT: "#7A4A00",
    Outcome.OVERTURNED_AFTER_IMPACT: "#E69F00",
    Outcome.FAILED: "#000000",
    Outcome.LOST_CONTACT: "#CC79A7",
    Outcome.LEANING: "#009E73",
    Outcome.SLID: "#F0E442",
}
SIGNS = {
    Outcome.NOT_COMPUTED: "?",
    Outcome.NO_UPLIFT: " ",
    Outcome.ROCKED: ".",
    Outcome.OVERTURNED_NO_IMPACT: "#",
    Outcome.OVERTURNED_AFTER_IMPACT: "o",
    Outcome.FAILED: "!",
    Outcome.LOST_CONTACT: "^",
    Outcome.LEANING: "/",
    Outcome.SLID: "~",
}
DIFFERENCES = {  # without those that figures do not show
    Difference.LINEAR_UNSAFE: "#D55E00",
    Difference.LINEAR_FALSE_ALARM: "#0072B2",
}
