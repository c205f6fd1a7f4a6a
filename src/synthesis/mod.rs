//! Which exemplar block every crossing copies. Zhao 2012 §5.3-5.5.
