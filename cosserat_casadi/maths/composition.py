"""A symmetric composition of order eight: steps of order two whose errors cancel.

Let Φ_h be a symmetric step of order two, Φ_{-h} its inverse. Then Φ_{γ₁h} ∘ … ∘ Φ_{γ₁₅h} is a step of order eight that
keeps whatever every Φ keeps: a group, a symmetry, a symplectic form. M. Suzuki, K. Umeno, in *Computer Simulation
Studies in Condensed-Matter Physics VI*, Springer 1993; R. I. McLachlan, SIAM J. Sci. Comput. 16 (1995) 151; the digits
are those of E. Hairer, C. Lubich, G. Wanner, *Geometric Numerical Integration*, Springer 2006, section V.3.2.
"""

from __future__ import annotations

_FIRST_HALF = (
    0.74167036435061295344822780,
    -0.40910082580003159399730010,
    0.19075471029623837995387626,
    -0.57386247111608226665638773,
    0.29906418130365592384446354,
    0.33462491824529818378495798,
    0.31529309239676659663205666,
)

_MIDDLE = -0.79688793935291635401978884

SHARES = (*_FIRST_HALF, _MIDDLE, *reversed(_FIRST_HALF))
"""Shares γ of a step that its stages take; some go back. They add up to one."""
