//! Gradients of whole images: against closed forms, finite differences, and each other.

mod analytic_crease;
mod analytic_edge;
mod analytic_irradiance;
mod analytic_shadow;
mod analytic_sharp_shadow;
mod beams;
mod black;
mod chains;
mod determinism;
mod edges;
mod finite_differences;
mod finite_differences_delta;
mod finite_differences_foliage;
mod finite_differences_indirect;
mod finite_differences_keys;
mod finite_differences_layers;
mod finite_differences_materials;
mod finite_differences_pictures;
mod hidden_edges;
mod last_vertex;
mod lens;
#[cfg(feature = "long-tests")]
mod long;
mod mixtures;
mod needs;
mod refusals;
mod second_estimator;
mod see_through;
mod sharp_shadows_seen;
mod smooth_in_mixtures;
mod standard_errors;
mod transposition;
mod transposition_ends;
mod transposition_materials;
mod warped_claims;
mod warped_transposition;
