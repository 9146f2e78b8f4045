//! The folders of all shards of a batch, and what each holds of its jobs.

use super::results::journal;
use super::results::line::ResultLine;
use super::results::manifest::Manifest;
use crate::jobs::failure::Failure;
use crate::jobs::id::{MANIFEST, RESULTS};
use crate::output::FileError;
use std::collections::BTreeMap;
use std::fs::{self, File};
use std::path::{Path, PathBuf};

/// What one folder holds.
pub struct Part {
    pub directory: PathBuf,
    pub manifest: Manifest,
    pub lines: Vec<ResultLine>,
    /// Held until it is merged: nothing in it changes.
    _lock: File,
}

impl Part {
    /// Reads it; all of its jobs must be done.
    pub fn read(directory: &Path) -> Result<Self, Failure> {
        let Some(lock) = journal::hold(directory)? else {
            return Err(Failure::Disagreement(format!(
                "{}: a batch is still writing there; merge once it has ended",
                directory.display()
            )));
        };
        let manifest = Manifest::read(directory)?;
        let path = directory.join(RESULTS);
        let bytes = fs::read(&path).map_err(|error| FileError::unread(&path, &error))?;
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
        check_count(directory, &manifest, read.done.len())?;
        Ok(Self {
            directory: directory.to_path_buf(),
            manifest,
            lines: read.done.into_iter().map(|(line, _)| line).collect(),
            _lock: lock,
        })
    }
}

/// A shard that was interrupted has fewer results than jobs.
fn check_count(directory: &Path, manifest: &Manifest, results: usize) -> Result<(), Failure> {
    let what = match manifest.count {
        Some(count) if count == results => return Ok(()),
        Some(count) if count > results => {
            format!("only {results} of {count} jobs are done; run this shard again with --resume")
        }
        Some(count) => format!(
            "it has {results} results of {count} jobs: its job file has lost some since; take their lines out of {RESULTS}"
        ),
        None => format!(
            "{MANIFEST} does not say how many jobs there are, as earlier versions did not; run this shard again with \
             --resume, which adds that and does nothing twice"
        ),
    };
    let what = format!("{}: {what}", directory.display());
    Err(Failure::Disagreement(what))
}

/// All shards of one batch, each once.
pub fn check_alike(parts: &[Part]) -> Result<(), Failure> {
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
pub type Jobs<'a> = BTreeMap<(usize, String), Vec<(&'a Part, &'a ResultLine)>>;

/// Of shards of samples: every shard has a share of every job.
pub fn by_job(parts: &[Part]) -> Result<Jobs<'_>, Failure> {
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

/// Of shards of jobs: every job is in one of them.
pub fn of_each_once(parts: &[Part]) -> Result<Jobs<'_>, Failure> {
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
