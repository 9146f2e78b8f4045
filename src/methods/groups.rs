//! Independent groups of samples: how many.

/// Independent groups of samples behind a standard error, at least.
const MIN_GROUPS: u32 = 4;

/// The groups behind standard errors of `spp` samples a pixel.
pub fn group_count(spp: u32) -> u32 {
    equal_groups(spp, MIN_GROUPS)
}

/// The smallest number of equal groups of `spp` samples that is at least `least`, or one sample
/// each.
pub fn equal_groups(spp: u32, least: u32) -> u32 {
    (least..=spp)
        .find(|g| spp.is_multiple_of(*g))
        .unwrap_or(spp)
}
