//! `[render]`: how the images of each step are rendered.

use super::schedule::Schedule;
use crate::jobs::config::table::Table;
use crate::jobs::failure::Failure;
use crate::jobs::resolution::check_resolution;
use crate::jobs::settings::MOST_SAMPLES;
use crate::methods::{ESTIMATORS, Method};

/// How the images of each step are rendered.
#[derive(Clone, Debug)]
pub struct RenderSettings {
    /// Camera paths per pixel of the derivative.
    pub spp: Schedule,
    /// Of the image in the loss, which has samples of its own; those of the derivative if not said.
    pub loss_spp: Option<Schedule>,
    /// Width and height of every view; those of its target or its sensor if not said.
    pub resolution: Option<[u32; 2]>,
    /// Views are rendered smaller by this whole factor.
    pub downscale: Schedule,
    /// Segments; `u32::MAX` for no limit; the scene's if not said.
    pub max_depth: Option<u32>,
    pub method: Method,
    /// Parts of a view's samples that several processes can do.
    pub shares: u32,
    pub adaptive: Option<Adaptive>,
}

/// Samples as many as the gradient's noise asks for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Adaptive {
    /// The gradient's noise over its signal is held below this.
    pub noise_to_signal: f64,
    /// Never more samples a pixel than these.
    pub most_spp: u32,
}

pub fn read(table: &Table) -> Result<RenderSettings, Failure> {
    let mut render = RenderSettings {
        spp: Schedule::Constant(16.0),
        loss_spp: None,
        resolution: None,
        downscale: Schedule::Constant(1.0),
        max_depth: None,
        method: Method::default(),
        shares: 1,
        adaptive: None,
    };
    let Some(inner) = table.table("render")? else {
        return Ok(render);
    };
    let wanted = format!("whole numbers of samples from 1 to {MOST_SAMPLES}");
    let is_spp = |v: f64| v.fract() == 0.0 && (1.0..=f64::from(MOST_SAMPLES)).contains(&v);
    if let Some(spp) = Schedule::read(&inner, "spp", &wanted, is_spp)? {
        render.spp = spp;
    }
    render.loss_spp = Schedule::read(&inner, "loss_spp", &wanted, is_spp)?;
    let is_factor = |v: f64| v.fract() == 0.0 && (1.0..=64.0).contains(&v);
    let wanted = "whole factors from 1 to 64, such as [[0, 4], [50, 1]]";
    if let Some(downscale) = Schedule::read(&inner, "downscale", wanted, is_factor)? {
        render.downscale = downscale;
    }
    render.resolution = resolution(&inner)?;
    render.max_depth = max_depth(&inner)?;
    let names: Vec<&str> = ESTIMATORS.iter().map(|e| e.name).collect();
    if let Some(name) = inner.choice("method", &names)? {
        render.method = Method::named(name).unwrap_or_default();
    }
    if let Some(shares) = inner.count("shares", 1, 4096)? {
        render.shares = shares as u32;
    }
    render.adaptive = adaptive(&inner)?;
    inner.finish()?;
    Ok(render)
}

fn resolution(table: &Table) -> Result<Option<[u32; 2]>, Failure> {
    let Some(sides) = table.numbers("resolution")? else {
        return Ok(None);
    };
    let wrong = || {
        table.error(
            "resolution",
            "write [width, height] in pixels, as in [128, 128]",
        )
    };
    let whole = |side: &f64| side.fract() == 0.0 && (1.0..=65536.0).contains(side);
    match sides.as_slice() {
        [width, height] if whole(width) && whole(height) => {
            let sides = check_resolution([*width as u32, *height as u32]);
            sides.map(Some).map_err(|_| wrong())
        }
        _ => Err(wrong()),
    }
}

fn max_depth(table: &Table) -> Result<Option<u32>, Failure> {
    let wanted = "a number of segments from 1, or -1 for no limit";
    match table.number("max_depth")? {
        None => Ok(None),
        Some(-1.0) => Ok(Some(u32::MAX)),
        Some(n) if n.fract() == 0.0 && (1.0..1e9).contains(&n) => Ok(Some(n as u32)),
        Some(n) => Err(table.error("max_depth", format!("write {wanted}, not {n}"))),
    }
}

fn adaptive(table: &Table) -> Result<Option<Adaptive>, Failure> {
    let Some(inner) = table.table("adaptive")? else {
        return Ok(None);
    };
    let adaptive = Adaptive {
        noise_to_signal: inner
            .number_if("noise_to_signal", 1.0, "a number above zero", |v| v > 0.0)?,
        most_spp: inner
            .count("most_spp", 1, MOST_SAMPLES.into())?
            .unwrap_or(256) as u32,
    };
    inner.finish()?;
    Ok(Some(adaptive))
}
