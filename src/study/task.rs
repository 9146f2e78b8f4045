//! One direction of one scene, ready to be measured.

use super::config::{DirectionPlan, Plan, ScenePlan};
use crate::jobs::direction::{self, Direction};
use crate::jobs::failure::Failure;
use crate::jobs::settings::{self, RequestedSettings};
use crate::methods::{self, Settings};
use crate::scene::Scene;
use crate::scene::source::Fnv1a;
use crate::trace::Backend;

/// One direction of one scene.
pub struct Task<'a> {
    pub scene: &'a Scene,
    pub plan: &'a ScenePlan,
    pub name: &'a str,
    pub direction: Direction,
    /// But for the method, the samples and the seed.
    pub settings: Settings,
    /// Width and height of the images.
    pub size: [usize; 2],
    /// The usual step of finite differences.
    pub step: f64,
    /// FNV-1a of what the reference depends on, and of what the whole depends on.
    pub reference_key: u64,
    pub key: u64,
}

/// FNV-1a of the program that runs: what another one found is no reference for this one.
pub fn program_hash() -> Result<u64, Failure> {
    let bytes = std::env::current_exe().and_then(std::fs::read);
    let bytes = bytes.map_err(|e| Failure::System(format!("cannot read the program: {e}")))?;
    let mut hash = Fnv1a::default();
    hash.write(&bytes);
    Ok(hash.0)
}

impl<'a> Task<'a> {
    /// Finds the parameters, and refuses what the scene has not. `program` is [`program_hash`].
    pub fn new(
        scene: &'a Scene,
        plan: &'a Plan,
        of: &'a ScenePlan,
        moves: &'a DirectionPlan,
        threads: usize,
        backend: Backend,
        program: u64,
    ) -> Result<Self, Failure> {
        let requested = RequestedSettings {
            seed: Some(plan.seed),
            spp: Some(of.effort.spp[0]),
            max_depth: of.effort.max_depth,
            resolution: of.effort.resolution,
            backend,
            standard_error: true,
            threads,
            ..RequestedSettings::default()
        };
        let settings = requested.settle(scene)?;
        let placed = |failure: Failure| match failure {
            Failure::Input(what) => Failure::Input(format!("{}: {what}", moves.place)),
            other => other,
        };
        let direction = direction::resolve(scene, &moves.tangents, 0).map_err(placed)?;
        if direction::is_zero(&direction) {
            let what = "all tangents are zero: nothing moves that could be measured";
            return Err(placed(Failure::Input(what.into())));
        }
        let step = methods::difference_step(scene, &settings, &direction)
            .map_err(|error| placed(Failure::from_engine(error, None)))?;
        let size = settings::size(&settings, scene).map(|side| side as usize);
        let mut hash = Fnv1a::default();
        let mut put = |text: String| hash.write(format!("{text}\n").as_bytes());
        put(format!("{program} {:?}", of.effort.reference));
        put(format!(
            "{} {} {}",
            scene.hash, settings.seed, settings.max_depth
        ));
        put(format!("{size:?} {:?} {backend}", of.defines));
        for (parameter, values) in &direction {
            put(format!("{} {values:?}", parameter.key));
        }
        let reference_key = hash.0;
        hash.write(format!("{:?} {} {}", of.effort, of.name, moves.name).as_bytes());
        Ok(Self {
            scene,
            plan: of,
            name: &moves.name,
            direction,
            settings,
            size,
            step,
            reference_key,
            key: hash.0,
        })
    }

    /// Numbers of an image.
    pub fn numbers(&self) -> usize {
        3 * self.size[0] * self.size[1]
    }

    /// Camera paths of one image.
    pub fn paths(&self, spp: u32) -> u64 {
        self.size[0] as u64 * self.size[1] as u64 * u64::from(spp)
    }
}
