//! Files that a job names beside its scene: compared with the scene, and counted, before they are
//! read.

use super::failure::Failure;
use super::job::Job;
use super::numbers::Numbers;
use super::pairs::Keys;
use super::pictures;
use super::settings;
use crate::methods::Settings;
use crate::scene::Scene;
use crate::scene::parameters;

/// What reading them takes in memory. One that does not fit the scene is refused by what its header
/// says.
pub fn bytes_needed(job: &Job, scene: &Scene, settings: &Settings) -> Result<u64, Failure> {
    let tangents = match &job.params {
        Some(Keys::Tangents(tangents)) => tangents.0.as_slice(),
        _ => &[],
    };
    let numbers = job.set.0.iter().chain(tangents);
    let mut bytes = 0u64;
    for (key, numbers) in numbers.filter(|(_, n)| matches!(n, Numbers::File(_))) {
        let parameter = parameters::find(scene, key)?;
        bytes = bytes.saturating_add(numbers.bytes_needed(&parameter, key)?);
    }
    if let Some(file) = job.adjoint.as_ref().or(job.target.as_ref()) {
        let picture = pictures::picture(file, settings::size(settings, scene))?;
        bytes = bytes.saturating_add(picture.bytes_needed());
    }
    Ok(bytes)
}
