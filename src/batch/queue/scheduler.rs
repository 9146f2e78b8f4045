//! Which shard this process is, by what it is told or by what its scheduler says.

use super::shard::Shard;
use crate::jobs::failure::Failure;
use std::collections::HashMap;
use std::str::FromStr;

/// `--shard`: given, or to be found in the environment.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ShardChoice {
    Given(Shard),
    /// By what Slurm, Open MPI, PMI or Kubernetes say; the count of a Kubernetes job has to be
    /// given.
    Auto(Option<u32>),
}

impl FromStr for ShardChoice {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let wrong = || "write I/N with I from 1 to N, as in 2/5, or auto, or auto/N".to_string();
        let (index, count) = match text.split_once('/') {
            None if text == "auto" => return Ok(ShardChoice::Auto(None)),
            None => return Err(wrong()),
            Some(parts) => parts,
        };
        let count: u64 = count.parse().map_err(|_| wrong())?;
        if index == "auto" {
            let count = u32::try_from(count).ok().filter(|n| *n > 0);
            return count.map(|n| ShardChoice::Auto(Some(n))).ok_or_else(wrong);
        }
        let index: u64 = index.parse().map_err(|_| wrong())?;
        match Shard::new(index, count) {
            Some(shard) => Ok(ShardChoice::Given(shard)),
            None => Err(format!(
                "shards are counted from 1 to N: {text} is none of them"
            )),
        }
    }
}

/// A scheduler's variables: the number of this process, that of all, and the number of the first.
struct Convention {
    name: &'static str,
    index: &'static str,
    count: Option<&'static str>,
    first: Option<&'static str>,
}

/// The most particular first: a step of an array task has both of Slurm's, and Open MPI's beside
/// them.
const CONVENTIONS: [Convention; 5] = [
    Convention {
        name: "Open MPI",
        index: "OMPI_COMM_WORLD_RANK",
        count: Some("OMPI_COMM_WORLD_SIZE"),
        first: None,
    },
    Convention {
        name: "PMI",
        index: "PMI_RANK",
        count: Some("PMI_SIZE"),
        first: None,
    },
    Convention {
        name: "a Slurm array",
        index: "SLURM_ARRAY_TASK_ID",
        count: Some("SLURM_ARRAY_TASK_COUNT"),
        first: Some("SLURM_ARRAY_TASK_MIN"),
    },
    Convention {
        name: "Slurm tasks",
        index: "SLURM_PROCID",
        count: Some("SLURM_NTASKS"),
        first: None,
    },
    Convention {
        name: "a Kubernetes indexed Job",
        index: "JOB_COMPLETION_INDEX",
        count: None,
        first: None,
    },
];

impl ShardChoice {
    /// The shard, looking at variables where it has to.
    pub fn resolve(self, variables: &HashMap<String, String>) -> Result<Shard, Failure> {
        let given = match self {
            ShardChoice::Given(shard) => return Ok(shard),
            ShardChoice::Auto(count) => count,
        };
        let ranked = |c: &&Convention| {
            let several = |name| variables.get(name).is_some_and(|n| n != "1");
            // A batch script runs as the only task of its job; then the array counts.
            variables.contains_key(c.index) && c.count.is_none_or(several)
        };
        let found = CONVENTIONS.iter().find(ranked);
        let lone = || CONVENTIONS.iter().find(|c| variables.contains_key(c.index));
        let Some(convention) = found.or_else(lone) else {
            let names: Vec<&str> = CONVENTIONS.iter().map(|c| c.index).collect();
            return Err(Failure::Usage(format!(
                "--shard auto finds none of {}; write --shard I/N",
                names.join(", ")
            )));
        };
        let number = |name: &str| -> Result<u64, Failure> {
            let text = variables.get(name).ok_or_else(|| {
                Failure::Usage(format!(
                    "--shard auto: {} ({}) sets no {name}; write --shard auto/N or I/N",
                    convention.name, convention.index
                ))
            })?;
            text.trim().parse().map_err(|_| {
                Failure::Usage(format!("--shard auto: {name}={text} is not a whole number"))
            })
        };
        let index = number(convention.index)?;
        let first = match convention.first {
            Some(name) if variables.contains_key(name) => number(name)?,
            _ => 0,
        };
        let count = match (given, convention.count) {
            (Some(count), _) => u64::from(count),
            (None, Some(name)) => number(name)?,
            (None, None) => {
                return Err(Failure::Usage(format!(
                    "--shard auto: {} does not say how many there are; write --shard auto/N, N being its completions",
                    convention.name
                )));
            }
        };
        let shard = index
            .checked_sub(first)
            .and_then(|i| Shard::new(i + 1, count));
        shard.ok_or_else(|| {
            Failure::Usage(format!(
                "--shard auto: {}={index}, counted from {first}, is none of {count} (an array with steps or gaps cannot be told apart; write --shard I/N)",
                convention.index
            ))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn auto(count: Option<u32>, variables: &[(&str, &str)]) -> Result<String, String> {
        let variables = variables.iter();
        let variables = variables
            .map(|(k, v)| (k.to_string(), v.to_string()))
            .collect();
        let shard = ShardChoice::Auto(count).resolve(&variables);
        shard.map(|s| s.to_string()).map_err(|e| e.to_string())
    }

    #[test]
    fn shards_are_counted_from_one() {
        let parsed = |text: &str| text.parse::<ShardChoice>();
        let given = |index, count| Ok(ShardChoice::Given(Shard { index, count }));
        assert_eq!(parsed("1/1"), given(1, 1));
        assert_eq!(parsed("5/16"), given(5, 16));
        assert_eq!(parsed("auto"), Ok(ShardChoice::Auto(None)));
        assert_eq!(parsed("auto/4"), Ok(ShardChoice::Auto(Some(4))));
        for wrong in [
            "",
            "0/2",
            "3/2",
            "1",
            "1/0",
            "-1/2",
            "a/b",
            "1/2/3",
            "auto/0",
            "1/99999999999",
        ] {
            assert!(parsed(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn schedulers_tell_the_shard() {
        let array = [
            ("SLURM_ARRAY_TASK_ID", "12"),
            ("SLURM_ARRAY_TASK_COUNT", "4"),
            ("SLURM_ARRAY_TASK_MIN", "10"),
            ("SLURM_PROCID", "0"),
            ("SLURM_NTASKS", "1"),
        ];
        assert_eq!(auto(None, &array), Ok("3/4".into()));
        let tasks = [("SLURM_PROCID", "3"), ("SLURM_NTASKS", "8")];
        assert_eq!(auto(None, &tasks), Ok("4/8".into()));
        let open_mpi = [("OMPI_COMM_WORLD_RANK", "0"), ("OMPI_COMM_WORLD_SIZE", "2")];
        assert_eq!(auto(None, &open_mpi), Ok("1/2".into()));
        let pmi = [("PMI_RANK", "1"), ("PMI_SIZE", "2")];
        assert_eq!(auto(None, &pmi), Ok("2/2".into()));
        let alone = [("PMI_RANK", "0"), ("PMI_SIZE", "1")];
        assert_eq!(auto(None, &alone), Ok("1/1".into()));
        let indexed = [("JOB_COMPLETION_INDEX", "6")];
        assert_eq!(auto(Some(7), &indexed), Ok("7/7".into()));
        assert!(auto(None, &indexed).unwrap_err().contains("auto/N"));
        assert!(auto(Some(6), &indexed).is_err());
        assert!(auto(None, &[]).is_err());
        let gaps = [
            ("SLURM_ARRAY_TASK_ID", "10"),
            ("SLURM_ARRAY_TASK_COUNT", "2"),
            ("SLURM_ARRAY_TASK_MIN", "0"),
        ];
        assert!(auto(None, &gaps).unwrap_err().contains("gaps"));
    }
}
