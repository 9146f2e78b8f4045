//! Shards put together: of jobs, by collecting them; of samples, by adding groups in their order.

use crate::batch::results::folder;
use crate::batch::results::journal::{self, Journal};
use crate::batch::results::line::ResultLine;
use crate::batch::results::manifest::Manifest;
use crate::batch::samples::share::PARTIAL;
use crate::batch::samples::sum::Sum;
use crate::jobs::failure::Failure;
use crate::jobs::id::RESULTS;
use crate::jobs::results::Results;
use crate::methods::inner_product;
use crate::output::tensors::TensorFile;
use crate::output::{FileError, atomic};
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

/// What one folder holds.
struct Part {
    directory: PathBuf,
    manifest: Manifest,
    lines: Vec<ResultLine>,
}

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

impl Part {
    fn read(directory: &Path) -> Result<Self, Failure> {
        let manifest = Manifest::read(directory)?;
        let path = directory.join(RESULTS);
        let bytes =
            fs::read(&path).map_err(|error| FileError::contents(&path, atomic::plain(&error)))?;
        let read = journal::read(&path, &bytes)?;
        if read.torn || read.failed > 0 {
            return Err(Failure::Disagreement(format!(
                "{}: {} jobs failed{}; run this shard again with --resume",
                path.display(),
                read.failed,
                if read.torn {
                    " and the last line is torn"
                } else {
                    ""
                }
            )));
        }
        Ok(Self {
            directory: directory.to_path_buf(),
            manifest,
            lines: read.done.into_iter().map(|(line, _)| line).collect(),
        })
    }
}

/// All shards of one batch, each once.
fn check_alike(parts: &[Part]) -> Result<(), Failure> {
    let unlike = |what: String| Err(Failure::Disagreement(what));
    let Some(first) = parts.first() else {
        return Err(Failure::Usage("name the folders of the shards".into()));
    };
    for part in parts {
        let (a, b) = (&first.manifest, &part.manifest);
        if a.kind() != b.kind() {
            return unlike(format!(
                "{} holds {b}, {} holds {a}: they are not of one batch",
                part.directory.display(),
                first.directory.display()
            ));
        }
        if a.jobs != b.jobs {
            return unlike(format!(
                "{} and {} were made from different job files",
                part.directory.display(),
                first.directory.display()
            ));
        }
    }
    for index in 1..=first.manifest.shards {
        let holders: Vec<_> = parts.iter().filter(|p| p.manifest.shard == index).collect();
        match holders[..] {
            [_] => {}
            [] => {
                return unlike(format!(
                    "shard {index}/{} is missing",
                    first.manifest.shards
                ));
            }
            [a, b, ..] => {
                return unlike(format!(
                    "{} and {} both hold shard {index}/{}",
                    a.directory.display(),
                    b.directory.display(),
                    first.manifest.shards
                ));
            }
        }
    }
    Ok(())
}

/// The shares of each job, in the order of the job file.
type Jobs<'a> = BTreeMap<(usize, String), Vec<(&'a Part, &'a ResultLine)>>;

fn by_job(parts: &[Part]) -> Result<Jobs<'_>, Failure> {
    let mut jobs: Jobs = BTreeMap::new();
    for part in parts {
        for line in &part.lines {
            let id = line.id.clone().unwrap_or_default();
            jobs.entry((line.line, id)).or_default().push((part, line));
        }
    }
    for ((line, id), shares) in &jobs {
        if shares.len() != parts.len() {
            let has = |part: &&Part| shares.iter().any(|(p, _)| p.directory == part.directory);
            let lacks = parts.iter().find(|part| !has(part));
            return Err(Failure::Disagreement(format!(
                "{} has no results of job {id} (line {line}); run this shard again with --resume",
                lacks.map_or("a shard".into(), |part| part
                    .directory
                    .display()
                    .to_string())
            )));
        }
        let (first_part, first) = shares[0];
        for (part, share) in shares {
            let whole =
                |line: &ResultLine| line.share.as_ref().map(|s| (s.groups, s.mode, s.stderr));
            if share.job != first.job
                || share.scene_hash != first.scene_hash
                || whole(share) != whole(first)
            {
                return Err(Failure::Disagreement(format!(
                    "job {id}: {} and {} had different jobs or scenes",
                    part.directory.display(),
                    first_part.directory.display()
                )));
            }
        }
    }
    Ok(jobs)
}

fn of_each_once(parts: &[Part]) -> Result<Jobs<'_>, Failure> {
    let mut jobs: Jobs = BTreeMap::new();
    let mut holders: BTreeMap<&str, &Part> = BTreeMap::new();
    for part in parts {
        for line in &part.lines {
            let id = line.id.as_deref().unwrap_or_default();
            if let Some(other) = holders.insert(id, part) {
                return Err(Failure::Disagreement(format!(
                    "job {id} is in {} and in {}",
                    other.directory.display(),
                    part.directory.display()
                )));
            }
            jobs.insert((line.line, id.to_string()), vec![(part, line)]);
        }
    }
    Ok(jobs)
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
    let wanted = |name: &str| {
        whole
            .outputs
            .as_ref()
            .is_none_or(|o| o.iter().any(|n| n == name))
    };
    files.retain(|file| wanted(file.name));
    result.files = folder::write(output, &id, &files)?;
    Ok(result)
}
