//! Shards put together: of jobs, by collecting them; of samples, by adding groups in their order.

use super::results::folder;
use super::results::journal::Journal;
use super::results::line::ResultLine;
use super::samples::share::PARTIAL;
use super::samples::sum::Sum;
use super::shard_folders::{Part, by_job, check_alike, of_each_once};
use crate::jobs::failure::Failure;
use crate::jobs::results::Results;
use crate::methods::inner_product;
use crate::output::results::is_wanted;
use crate::output::tensors::TensorFile;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// What was merged.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Merged {
    pub jobs: usize,
    pub shards: usize,
}

/// Merges the shards in `directories` into `output`.
pub fn merge(directories: &[PathBuf], output: &Path) -> Result<Merged, Failure> {
    let mut parts: Vec<Part> = Vec::new();
    for directory in directories {
        parts.push(Part::read(directory)?);
    }
    parts.sort_by_key(|part| part.manifest.shard);
    check_alike(&parts)?;
    let by_samples = parts[0].manifest.split == "samples";
    let jobs = match by_samples {
        true => by_job(&parts)?,
        false => of_each_once(&parts)?,
    };
    let (found, _) = Journal::look(output, false)?;
    let mut journal = found.begin()?;
    let count = jobs.len();
    for shares in jobs.into_values() {
        let result = match by_samples {
            true => add(&shares, output)?,
            false => collect(shares[0].0, shares[0].1, output)?,
        };
        journal.append(&result.text())?;
    }
    Ok(Merged {
        jobs: count,
        shards: parts.len(),
    })
}

/// Copies a whole job.
fn collect(part: &Part, line: &ResultLine, output: &Path) -> Result<ResultLine, Failure> {
    let id = line.id.as_deref().unwrap_or_default();
    let files: Vec<PathBuf> = line
        .files
        .values()
        .map(|path| part.directory.join(path))
        .collect();
    folder::copy(output, id, &files)?;
    Ok(line.clone())
}

/// Adds the groups of a job's shares.
fn add(shares: &[(&Part, &ResultLine)], output: &Path) -> Result<ResultLine, Failure> {
    let (_, first) = shares[0];
    let id = first.id.clone().unwrap_or_default();
    let Some(whole) = &first.share else {
        return Err(Failure::Disagreement(format!(
            "job {id} was not shared out by samples"
        )));
    };
    let mut files: Vec<TensorFile> = Vec::new();
    let mut owner: BTreeMap<u32, usize> = BTreeMap::new();
    for (part, line) in shares {
        let done = line.share.iter().flat_map(|share| &share.done);
        for &group in done {
            if owner.insert(group, files.len()).is_some() {
                return Err(Failure::Disagreement(format!(
                    "job {id}: group {group} is in two shards"
                )));
            }
        }
        if line.files.is_empty() {
            continue;
        }
        let path = part.directory.join(&id).join(PARTIAL);
        files.push(TensorFile::open(&path)?);
    }
    if let Some(missing) = (0..whole.groups).find(|group| !owner.contains_key(group)) {
        return Err(Failure::Disagreement(format!(
            "job {id}: group {missing} of {} is in no shard",
            whole.groups
        )));
    }
    let sum = Sum {
        share: whole,
        files,
        owner,
    };
    let (results, adjoint) = sum.results()?;
    let mut result = ResultLine {
        id: Some(id.clone()),
        line: first.line,
        job: first.job.clone(),
        status: "ok".into(),
        scene_hash: first.scene_hash.clone(),
        loss: shares.iter().find_map(|(_, line)| line.loss),
        norms: results.norms().into_iter().collect(),
        ..ResultLine::default()
    };
    if let (Results::Backward { image, .. }, Some(adjoint)) = (&results, adjoint) {
        result.loss = Some(inner_product(image, &adjoint));
    }
    for (_, line) in shares {
        for (kind, count) in &line.rays {
            *result.rays.entry(kind.clone()).or_default() += count;
        }
        for (cause, count) in &line.rejected {
            *result.rejected.entry(cause.clone()).or_default() += count;
        }
    }
    let mut files = results.files()?;
    files.retain(|file| is_wanted(file.name, whole.outputs.as_deref()));
    result.files = folder::write(output, &id, &files)?;
    Ok(result)
}
