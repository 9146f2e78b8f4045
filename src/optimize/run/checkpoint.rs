//! The state in a file, from which a run goes on to the same bytes.
//!
//! A line of JSON, then the numbers as little-endian doubles, then a hash of all that. It is
//! written beside the old one and renamed, so that there is always a whole one.

use super::record::Record;
use super::state::State;
use crate::files;
use crate::jobs::failure::Failure;
use crate::optimize::optimizer::Memory;
use crate::optimize::problem::Problem;
use crate::output::{FileError, atomic};
use crate::scene::source::Fnv1a;
use crate::scene::{Mesh, Normals};
use glam::{Vec2, Vec3};
use serde::{Deserialize, Serialize};
use std::io::Write;
use std::path::Path;

/// Its name in the folder of a run.
pub const NAME: &str = "checkpoint.bin";

const HASH_BYTES: usize = 8;

#[derive(Serialize, Deserialize)]
struct Header {
    version: String,
    /// Of the configuration and of the scene: another run's state would be nonsense.
    config: String,
    scene: String,
    step: u64,
    doublings: u32,
    refused_in_turn: u32,
    ended: Option<String>,
    history: Vec<Record>,
    variables: Vec<VariableHeader>,
}

#[derive(Serialize, Deserialize)]
struct VariableHeader {
    key: String,
    latent: usize,
    first: usize,
    second: usize,
    steps: u64,
    /// Vertices, triangles and texture coordinates of its mesh, if that is another than the
    /// scene's.
    mesh: Option<[usize; 3]>,
}

/// Writes the state, so that it survives a power cut.
pub fn write(directory: &Path, problem: &Problem, state: &State) -> Result<(), Failure> {
    let bytes = encode(problem, state)?;
    atomic::write_durably(&directory.join(NAME), |file| file.write_all(&bytes))?;
    Ok(())
}

fn encode(problem: &Problem, state: &State) -> Result<Vec<u8>, Failure> {
    let mut numbers: Vec<f64> = Vec::new();
    let mut variables = Vec::new();
    for (i, variable) in problem.variables.iter().enumerate() {
        let memory = &state.memories[i];
        numbers.extend(&state.latents[i]);
        numbers.extend(&memory.first);
        numbers.extend(&memory.second);
        let mesh = state.meshes[i].as_ref().map(|mesh| {
            numbers.extend(mesh.positions.iter().flat_map(|p| p.as_dvec3().to_array()));
            numbers.extend(mesh.triangles.iter().flatten().map(|&v| f64::from(v)));
            numbers.extend(mesh.uvs.iter().flat_map(|uv| uv.as_dvec2().to_array()));
            [mesh.positions.len(), mesh.triangles.len(), mesh.uvs.len()]
        });
        variables.push(VariableHeader {
            key: variable.parameter.key.clone(),
            latent: state.latents[i].len(),
            first: memory.first.len(),
            second: memory.second.len(),
            steps: memory.steps,
            mesh,
        });
    }
    let header = Header {
        version: env!("CARGO_PKG_VERSION").into(),
        config: format!("{:016x}", problem.config.hash),
        scene: format!("{:016x}", problem.base.scene.hash),
        step: state.step,
        doublings: state.doublings,
        refused_in_turn: state.refused_in_turn,
        ended: state.ended.clone(),
        history: state.history.clone(),
        variables,
    };
    let header = serde_json::to_string(&header).map_err(|e| Failure::System(e.to_string()))?;
    let mut bytes = header.into_bytes();
    bytes.push(b'\n');
    bytes.extend(numbers.iter().flat_map(|v| v.to_le_bytes()));
    let hash = hash_of(&bytes);
    bytes.extend(hash.to_le_bytes());
    Ok(bytes)
}

fn hash_of(bytes: &[u8]) -> u64 {
    let mut hash = Fnv1a::default();
    hash.write(bytes);
    hash.0
}

/// Reads the state of a run of the same configuration and scene.
pub fn read(directory: &Path, problem: &Problem) -> Result<State, Failure> {
    let path = directory.join(NAME);
    let bytes = files::read(&path).map_err(|error| FileError::unread(&path, &error))?;
    let said = |what: String| format!("{}: {what}", path.display());
    let (header, numbers) = header(&bytes).map_err(|what| Failure::Input(said(what)))?;
    refuse_other(&header, problem).map_err(|what| Failure::Usage(said(what)))?;
    decode(header, numbers, problem).map_err(|what| Failure::Input(said(what)))
}

fn broken() -> String {
    "not a whole checkpoint; begin anew without --resume".to_string()
}

/// The header, and the bytes of the numbers, of a file that is whole.
fn header(bytes: &[u8]) -> Result<(Header, &[u8]), String> {
    let (body, hash) = bytes
        .split_at_checked(bytes.len().saturating_sub(HASH_BYTES))
        .ok_or_else(broken)?;
    let hash = <[u8; HASH_BYTES]>::try_from(hash).map_err(|_| broken())?;
    if u64::from_le_bytes(hash) != hash_of(body) {
        return Err(broken());
    }
    let line = body.iter().position(|b| *b == b'\n').ok_or_else(broken)?;
    let header = serde_json::from_slice(&body[..line]).map_err(|_| broken())?;
    Ok((header, &body[line + 1..]))
}

/// Says what a checkpoint is of that the run is not.
fn refuse_other(header: &Header, problem: &Problem) -> Result<(), String> {
    let is = [
        (
            "program",
            &header.version,
            env!("CARGO_PKG_VERSION").to_string(),
        ),
        (
            "configuration or --set",
            &header.config,
            format!("{:016x}", problem.config.hash),
        ),
        (
            "scene",
            &header.scene,
            format!("{:016x}", problem.base.scene.hash),
        ),
    ];
    for (what, written, now) in is {
        if *written != now {
            return Err(format!(
                "it is of another {what}; take another folder with -o, or begin anew without --resume"
            ));
        }
    }
    Ok(())
}

fn decode(header: Header, numbers: &[u8], problem: &Problem) -> Result<State, String> {
    let (chunks, rest) = numbers.as_chunks::<8>();
    let mut numbers = chunks.iter().map(|b| f64::from_le_bytes(*b));
    let mut take = |count: usize| -> Result<Vec<f64>, String> {
        let taken: Vec<f64> = numbers.by_ref().take(count).collect();
        (taken.len() == count).then_some(taken).ok_or_else(broken)
    };
    let mut state = State {
        step: header.step,
        latents: Vec::new(),
        memories: Vec::new(),
        history: header.history,
        doublings: header.doublings,
        refused_in_turn: header.refused_in_turn,
        meshes: Vec::new(),
        ended: header.ended,
    };
    if header.variables.len() != problem.variables.len() || !rest.is_empty() {
        return Err(broken());
    }
    for (variable, own) in header.variables.iter().zip(&problem.variables) {
        if variable.key != own.parameter.key {
            return Err(broken());
        }
        state.latents.push(take(variable.latent)?);
        state.memories.push(Memory {
            steps: variable.steps,
            first: take(variable.first)?,
            second: take(variable.second)?,
        });
        let mesh = match variable.mesh {
            None => None,
            Some([vertices, triangles, uvs]) => Some(Mesh {
                positions: vectors(&take(3 * vertices)?),
                triangles: take(3 * triangles)?
                    .as_chunks::<3>()
                    .0
                    .iter()
                    .map(|t| t.map(|v| v as u32))
                    .collect(),
                uvs: take(2 * uvs)?
                    .as_chunks::<2>()
                    .0
                    .iter()
                    .map(|uv| Vec2::from(uv.map(|v| v as f32)))
                    .collect(),
                normals: Normals::Flat,
                ..Mesh::default()
            }),
        };
        state.meshes.push(mesh);
    }
    Ok(state)
}

fn vectors(numbers: &[f64]) -> Vec<Vec3> {
    let all = numbers.as_chunks::<3>().0.iter();
    all.map(|p| Vec3::from(p.map(|v| v as f32))).collect()
}
