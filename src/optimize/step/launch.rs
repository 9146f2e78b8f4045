//! What a launcher, mpirun or srun, says of the processes it has started together.

/// Processes that were started together.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Launch {
    /// The command that starts them.
    pub launcher: &'static str,
    pub processes: u64,
}

/// Where each launcher says how many it has started. Slurm's own count of tasks, `SLURM_NTASKS`, is
/// also told to the one process that runs the script of `sbatch`; that of a step is not.
const COUNTS: [(&str, &str); 3] = [
    ("OMPI_COMM_WORLD_SIZE", "mpirun"),
    ("PMI_SIZE", "mpiexec"),
    ("SLURM_STEP_NUM_TASKS", "srun"),
];

impl Launch {
    /// What the environment tells; none if this process was started alone.
    pub fn of(variable: &dyn Fn(&str) -> Option<String>) -> Option<Self> {
        COUNTS.iter().find_map(|&(name, launcher)| {
            let processes = variable(name)?.parse().ok()?;
            (processes > 1).then_some(Self {
                launcher,
                processes,
            })
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_more_than_one_process_is_a_launch() {
        let of = |set: &[(&str, &str)]| {
            Launch::of(&|name| {
                let found = set.iter().find(|(known, _)| *known == name);
                found.map(|(_, value)| value.to_string())
            })
        };
        let launch = |launcher, processes| {
            Some(Launch {
                launcher,
                processes,
            })
        };
        assert_eq!(of(&[]), None);
        assert_eq!(of(&[("OMPI_COMM_WORLD_SIZE", "1")]), None);
        assert_eq!(of(&[("OMPI_COMM_WORLD_SIZE", "many")]), None);
        // The script of sbatch.
        assert_eq!(of(&[("SLURM_NTASKS", "4"), ("SLURM_PROCID", "0")]), None);
        assert_eq!(of(&[("OMPI_COMM_WORLD_SIZE", "3")]), launch("mpirun", 3));
        // mpirun on one process of a Slurm step: what mpirun says is nearer.
        let nested = [("SLURM_STEP_NUM_TASKS", "2"), ("OMPI_COMM_WORLD_SIZE", "4")];
        assert_eq!(of(&nested), launch("mpirun", 4));
        assert_eq!(of(&[("PMI_SIZE", "2")]), launch("mpiexec", 2));
        assert_eq!(of(&[("SLURM_STEP_NUM_TASKS", "2")]), launch("srun", 2));
    }
}
