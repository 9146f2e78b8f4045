//! References of the scenes.

use crate::Result;
use crate::cases::{Case, Options};
use crate::process::{differences, scratch};
use crate::shared::accuracy::Reference;
use crate::shared::program::Program;
use warpath::output::npy;

/// The given one, or one by finite differences, made once and kept.
pub fn read(program: &Program, case: &Case, options: &Options) -> Result<Reference> {
    let own = scratch().join("reference");
    let folder = case.given.as_ref().unwrap_or(&own);
    let file = |kind: &str| folder.join(format!("{}.{}{kind}.npy", case.name, case.filter));
    if case.given.is_none() && !file("").exists() {
        std::fs::create_dir_all(folder)?;
        let (mean, stderr, shape) = average(program, case, options)?;
        npy::write(&file(".stderr"), &shape, stderr)?;
        npy::write(&file(""), &shape, mean)?;
    }
    let (array, stderr) = (npy::read(&file(""))?, npy::read(&file(".stderr"))?.values);
    let &[height, width, 3] = array.shape.as_slice() else {
        return Err("a reference that is no image".into());
    };
    Ok(Reference::new(array.values, stderr, [width, height]))
}

type Averaged = (Vec<f32>, Vec<f32>, Vec<usize>);

fn average(program: &Program, case: &Case, options: &Options) -> Result<Averaged> {
    let (mut sum, mut variance, mut shape) = (Vec::new(), Vec::new(), Vec::new());
    for run in 1..=options.reference_runs {
        eprintln!(
            "{} ({}): reference, run {run} of {}",
            case.name, case.filter, options.reference_runs
        );
        // Seeds that the runs to be judged do not use.
        let seed = 1_000_000 + run;
        let done = differences(program, case, options.reference_spp, seed)?;
        sum.resize(done.gradient.len(), 0.0f64);
        variance.resize(done.gradient.len(), 0.0f64);
        for (i, (value, error)) in done.gradient.iter().zip(&done.stderr).enumerate() {
            sum[i] += *value as f64;
            variance[i] += (*error as f64).powi(2);
        }
        shape = vec![done.size[1], done.size[0], 3];
    }
    let n = options.reference_runs as f64;
    let mean = sum.iter().map(|s| (s / n) as f32).collect();
    let stderr = variance.iter().map(|v| (v.sqrt() / n) as f32).collect();
    Ok((mean, stderr, shape))
}
