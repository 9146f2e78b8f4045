//! Published methods that move samples with what they see, instead of finding borders: those of
//! Loubet et al. (2019) and of Bangaru et al. (2020). Both are biased, as published.

mod boundary_distance;
mod bundle;
pub mod loubet;
mod of_two;
pub mod options;
pub mod warped_area;
