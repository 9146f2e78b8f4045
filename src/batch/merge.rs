//! Shards put together: of jobs, by collecting them; of samples, by adding groups in their order.

use super::results::folder;
use super::results::journal::Journal;
use super::results::line::ResultLine;
use super::samples::share::PARTIAL;
use super::samples::sum::Sum;
use super::shard_folders::{Part, by_job, check_alike, of_each_once};
use crate::files::Regular;
use crate::jobs::failure::Failure;
use crate::jobs::id::RESULTS;
use crate::jobs::results::Results;
use crate::methods::inner_product;
use crate::output::FileError;
use crate::output::results::is_wanted;
use crate::output::tensors::TensorFile;
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

/// What was merged.
#[derive(Clone, Debug)]
pub struct Merged {
    pub jobs: usize,
    pub shards: usize,
    /// What traced the rays of all shards.
    pub backend: String,
    pub rays: BTreeMap<String, u64>,
    pub rejected: BTreeMap<String, u64>,
    /// Of all jobs, from the output directory.
    pub files: Vec<String>,
}

/// Merges the shards in `directories` into `output`. All that the shards hold is looked at before
/// anything is written, and results are written last: where they are, all is there.
pub fn merge(directories: &[PathBuf], output: &Path) -> Result<Merged, Failure> {
    refuse_results(output)?;
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
    for ((_, id), shares) in &jobs {
        folder::refuse_taken(output, id)?;
        match by_samples {
            true => sum_of(shares)?.check()?,
            false => check_files(shares[0].0, shares[0].1)?,
        }
    }
    let (found, _) = Journal::look(output, false)?;
    let mut merged = Merged {
        jobs: jobs.len(),
        shards: parts.len(),
        backend: parts[0].manifest.backend.clone(),
        rays: BTreeMap::new(),
        rejected: BTreeMap::new(),
        files: Vec::new(),
    };
    let mut lines = Vec::new();
    for shares in jobs.into_values() {
        let result = match by_samples {
            true => add(&shares, output)?,
            false => collect(shares[0].0, shares[0].1, output)?,
        };
        lines.push(result.text());
        add_counts(&mut merged.rays, &result.rays);
        add_counts(&mut merged.rejected, &result.rejected);
        merged.files.extend(result.files.into_values());
    }
    found.write(&lines)?;
    Ok(merged)
}

/// A merge begins anew or not at all.
fn refuse_results(output: &Path) -> Result<(), Failure> {
    let path = output.join(RESULTS);
    match fs::metadata(&path) {
        Ok(about) if about.len() > 0 => Err(Failure::Usage(format!(
            "{} has results already: choose another -o",
            path.display()
        ))),
        _ => Ok(()),
    }
}

fn add_counts(sums: &mut BTreeMap<String, u64>, counts: &BTreeMap<String, u64>) {
    for (name, count) in counts {
        *sums.entry(name.clone()).or_default() += count;
    }
}

/// The files of a job that one shard has done.
fn files_of(part: &Part, line: &ResultLine) -> Vec<PathBuf> {
    let files = line.files.values();
    files.map(|path| part.directory.join(path)).collect()
}

/// Refuses files that cannot be read.
fn check_files(part: &Part, line: &ResultLine) -> Result<(), FileError> {
    for path in files_of(part, line) {
        Regular::open(&path).map_err(|error| FileError::unread(&path, &error))?;
    }
    Ok(())
}

/// Copies a whole job.
fn collect(part: &Part, line: &ResultLine, output: &Path) -> Result<ResultLine, Failure> {
    let id = line.id.as_deref().unwrap_or_default();
    folder::copy(output, id, &files_of(part, line))?;
    Ok(line.clone())
}

/// The groups of a job's shares, all of them there.
fn sum_of<'a>(shares: &[(&Part, &'a ResultLine)]) -> Result<Sum<'a>, Failure> {
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
    Ok(Sum {
        share: whole,
        files,
        owner,
    })
}

/// Adds the groups of a job's shares.
fn add(shares: &[(&Part, &ResultLine)], output: &Path) -> Result<ResultLine, Failure> {
    let (_, first) = shares[0];
    let id = first.id.clone().unwrap_or_default();
    let sum = sum_of(shares)?;
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
        add_counts(&mut result.rays, &line.rays);
        add_counts(&mut result.rejected, &line.rejected);
        result.note_missing(line.missing_part);
    }
    let mut files = results.files()?;
    files.retain(|file| is_wanted(file.name, sum.share.outputs.as_deref()));
    result.files = folder::write(output, &id, &files)?;
    Ok(result)
}
