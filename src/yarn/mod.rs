//! Yarns as geometry: what a recipe says of a yarn, how yarns of a small weave lie, and
//! where every fibre of every yarn runs.
//!
//! No open micro-CT of woven cloth exists, so exemplars are built from recipes. Data
//! passes through in this order: a [`YarnRecipe`] (fibres, plies, twist) and a weave
//! give a [`WeaveGeometry`] (centre curves and flattened cross-sections that do not pass
//! through each other); [`fibre`] lays the fibres of each yarn inside it. What comes out
//! is data to copy from, as a scan would be (Zhao 2012 §4).
//!
//! Curves are closed forms of the weave's ups and downs. Nothing is relaxed or solved.

pub mod fibre;
mod geometry;
mod noise;
mod recipe;
mod section;
pub mod tubes;

pub use geometry::{WeaveGeometry, YarnPath};
pub use noise::{hash, unit};
pub use recipe::{RecipeError, YarnRecipe};
pub use section::{CrossSection, CutThread, MOST_CROSSINGS, cross_section};
