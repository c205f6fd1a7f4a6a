//! Centre curves of yarns from a weave, cross-sections, plies and fibres.
