//! Several processes, by MPI.
//!
//! Whatever a process waits for begins with one and the same round, in which each says how it does.
//! So one that has failed by itself, at whatever point, is heard wherever the others are. After a
//! round that says no nothing more is sent.

use super::launch::Launch;
use super::ranks::{Ranks, outcome};
use crate::jobs::failure::Failure;
use crate::room;
use mpi::Threading;
use mpi::environment::{Universe, initialize_with_threading};
use mpi::topology::SimpleCommunicator;
use mpi::traits::{Communicator, CommunicatorCollectives, Root};
use std::cell::OnceCell;

/// Numbers in one message: MPI counts them in 31 bits.
const MESSAGE: usize = 1 << 28;

/// What a process says of itself in a round: that it is well, or this with its exit code.
const FAILED: u64 = 1 << 8;

/// The process that writes and speaks.
const WRITER: usize = 0;

/// Processes that MPI connects.
pub struct MessagePassing {
    world: SimpleCommunicator,
    /// Why no more is sent.
    over: OnceCell<Failure>,
    // Ends MPI when it is dropped, which waits for all processes.
    _universe: Universe,
}

impl MessagePassing {
    /// Joins the processes that a launcher has started.
    pub fn start(launch: &Launch) -> Result<Self, Failure> {
        // Without it Open MPI ends the process, and does not say that srun has another option.
        if launch.launcher == "srun" && std::env::var_os("PMIX_RANK").is_none() {
            return Err(unconnected(launch));
        }
        // Threads trace; only the one that started MPI sends.
        let started = initialize_with_threading(Threading::Funneled);
        let (universe, _) =
            started.ok_or_else(|| Failure::System("MPI has been started before".into()))?;
        let world = universe.world();
        if u64::try_from(world.size()) != Ok(launch.processes) {
            return Err(unconnected(launch));
        }
        Ok(Self {
            world,
            over: OnceCell::new(),
            _universe: universe,
        })
    }

    fn rank(&self) -> usize {
        self.world.rank() as usize
    }

    /// The process of a rank, for what it sends to all.
    fn send<T: mpi::datatype::Equivalence>(&self, from: usize, numbers: &mut [T]) {
        let root = self.world.process_at_rank(from as i32);
        for part in numbers.chunks_mut(MESSAGE) {
            root.broadcast_into(part);
        }
    }

    /// Each process's words on itself: whether it is well, and a fingerprint.
    fn round(&self, own: &Result<(), Failure>, fingerprint: u64) -> Result<(), Failure> {
        let status = own
            .as_ref()
            .err()
            .map_or(0, |f| FAILED + u64::from(f.code()));
        let mut all = vec![0u64; 2 * self.count()];
        self.world
            .all_gather_into(&[status, fingerprint][..], &mut all[..]);
        let (said, _) = all.as_chunks::<2>();
        if let Some(failed) = said.iter().position(|[status, _]| *status != 0) {
            let text = own.as_ref().err().map(Failure::to_string);
            let mut bytes = text.unwrap_or_default().into_bytes();
            let mut length = [bytes.len() as u64];
            self.send(failed, &mut length);
            bytes.resize(length[0] as usize, 0);
            self.send(failed, &mut bytes);
            let code = (said[failed][0] - FAILED) as u8;
            return Err(self.heard(failed, code, &String::from_utf8_lossy(&bytes)));
        }
        match said.iter().position(|[_, other]| *other != said[WRITER][1]) {
            None => Ok(()),
            Some(other) => Err(Failure::System(format!(
                "processes {WRITER} and {other} of {} have come to other numbers: all must run the same program with \
                 the same options and files, on machines of one kind",
                self.count()
            ))),
        }
    }

    /// What another process has said of its failure.
    fn heard(&self, from: usize, code: u8, text: &str) -> Failure {
        let text = match from {
            WRITER => text.to_string(),
            _ => format!("process {from} of {}: {text}", self.count()),
        };
        match code {
            2 => Failure::Usage(text),
            3 => Failure::Input(text),
            129.. => Failure::Interrupted(code - 128),
            _ => Failure::System(text),
        }
    }
}

fn unconnected(launch: &Launch) -> Failure {
    Failure::Usage(format!(
        "{} has started {} processes that MPI does not connect: each would do the whole run and write the same \
         files; start them by the mpirun of the Open MPI that warpath is built with, or by srun --mpi=pmix",
        launch.launcher, launch.processes
    ))
}

impl Ranks for MessagePassing {
    fn map(
        &self,
        units: usize,
        work: &mut dyn FnMut(usize) -> Result<Vec<f32>, Failure>,
    ) -> Result<Vec<Vec<f32>>, Failure> {
        let owner = |unit: usize| unit % self.count();
        let mine = (0..units).filter(|unit| owner(*unit) == self.rank());
        let done: Result<Vec<Vec<f32>>, Failure> = mine.map(work).collect();
        self.agree(outcome(&done), &|| 0)?;
        let mut own = done?.into_iter();
        let mut mine = |unit| (owner(unit) == self.rank()).then(|| own.next()).flatten();
        let mut lengths = Vec::new();
        let own: Vec<Option<Vec<f32>>> = (0..units)
            .map(|unit| {
                let numbers = mine(unit);
                let mut length = [numbers.as_ref().map_or(0, |n| n.len() as u64)];
                self.send(owner(unit), &mut length);
                lengths.push(length[0] as usize);
                numbers
            })
            .collect();
        let room = |length| room::filled(0.0, length).map_err(|e| Failure::System(e.to_string()));
        let all: Result<Vec<Vec<f32>>, Failure> = own
            .into_iter()
            .zip(lengths)
            .map(|(numbers, length)| numbers.map_or_else(|| room(length), Ok))
            .collect();
        self.agree(outcome(&all), &|| 0)?;
        let mut all = all?;
        for (unit, numbers) in all.iter_mut().enumerate() {
            self.send(owner(unit), numbers);
        }
        Ok(all)
    }

    fn agree(
        &self,
        own: Result<(), Failure>,
        fingerprint: &dyn Fn() -> u64,
    ) -> Result<(), Failure> {
        if let Some(failure) = self.over.get() {
            return own.and(Err(failure.clone()));
        }
        let agreed = self.round(&own, fingerprint());
        if let Err(failure) = &agreed {
            let _ = self.over.set(failure.clone());
        }
        own.and(agreed)
    }

    fn writes(&self) -> bool {
        self.rank() == WRITER
    }

    fn count(&self) -> usize {
        self.world.size() as usize
    }
}
