//! What a study measures: methods, and methods with constants of their own.
//!
//! `[variant.NAME]` says a method and those of its constants that are not the published ones.

use crate::jobs::config::table::Table;
use crate::jobs::failure::Failure;
use crate::methods::{Constants, ESTIMATORS, Method};
use crate::warp::options::{LoubetOptions, WarpOptions, WarpedAreaOptions};

/// A method under a name.
#[derive(Clone, Debug, PartialEq)]
pub struct Contestant {
    pub name: String,
    pub method: Method,
    pub constants: Constants,
}

/// All methods, and the variants that a configuration has.
pub fn all(root: &Table) -> Result<Vec<Contestant>, Failure> {
    let methods = ESTIMATORS.iter().map(|row| Contestant {
        name: row.name.into(),
        method: row.method,
        constants: Constants::default(),
    });
    let mut all: Vec<Contestant> = methods.collect();
    let Some(variants) = root.table("variant")? else {
        return Ok(all);
    };
    for name in variants.keys() {
        if all.iter().any(|other| other.name == name) {
            return Err(variants.error(name, "a method has this name; take another"));
        }
        let plain = |c: char| c.is_ascii_alphanumeric() || matches!(c, '-' | '_');
        if name.is_empty() || !name.chars().all(plain) {
            return Err(variants.error(name, "use letters, digits, '-' and '_'"));
        }
        if let Some(table) = variants.table(name)? {
            all.push(variant(name, &table)?);
            table.finish()?;
        }
    }
    Ok(all)
}

fn variant(name: &str, table: &Table) -> Result<Contestant, Failure> {
    let names = [Method::Loubet.name(), Method::WarpedArea.name()];
    let method = table.choice("method", &names)?;
    let method = method.and_then(Method::named).ok_or_else(|| {
        let [one, other] = names;
        table.error(
            "method",
            format!("it is missing; write \"{one}\" or \"{other}\""),
        )
    })?;
    let mut warp = WarpOptions::default();
    match method {
        Method::Loubet => warp.loubet = loubet(table, warp.loubet)?,
        _ => warp.warped_area = warped_area(table, warp.warped_area)?,
    }
    Ok(Contestant {
        name: name.into(),
        method,
        constants: Constants {
            warp,
            ..Constants::default()
        },
    })
}

/// More rays than this are a typing error.
const MOST_RAYS: u64 = 4096;

fn rays(table: &Table, key: &str, usual: u32) -> Result<u32, Failure> {
    let rays = table.count(key, 2, MOST_RAYS)?;
    Ok(rays.map_or(usual, |rays| rays as u32))
}

fn pixels(table: &Table, key: &str, usual: f64) -> Result<f64, Failure> {
    let fits = |x: f64| (0.001..=4.0).contains(&x);
    table.number_if(key, usual, "a number of pixels from 0.001 to 4", fits)
}

fn kappa(table: &Table, key: &str, usual: f64) -> Result<f64, Failure> {
    let fits = |x: f64| (10.0..=1e8).contains(&x);
    table.number_if(key, usual, "a concentration from 10 to 1e8", fits)
}

fn loubet(table: &Table, usual: LoubetOptions) -> Result<LoubetOptions, Failure> {
    let is_alpha = |x: f64| (0.0..=1.0).contains(&x);
    let least = f64::from(usual.least_roughness);
    let least = table.number_if("least_roughness", least, "a number from 0 to 1", is_alpha)?;
    Ok(LoubetOptions {
        film_rays: rays(table, "film_rays", usual.film_rays)?,
        light_rays: rays(table, "light_rays", usual.light_rays)?,
        lobe_rays: rays(table, "lobe_rays", usual.lobe_rays)?,
        film_kernel_px: pixels(table, "film_kernel_px", usual.film_kernel_px)?,
        lobe_kappa: kappa(table, "lobe_kappa", usual.lobe_kappa)?,
        least_roughness: least as f32,
        environment_kappa: kappa(table, "environment_kappa", usual.environment_kappa)?,
        convolution: table.truth("convolution", usual.convolution)?,
        pairs: table.truth("pairs", usual.pairs)?,
    })
}

fn warped_area(table: &Table, usual: WarpedAreaOptions) -> Result<WarpedAreaOptions, Failure> {
    let is_exponent = |x: f64| (1.0..=16.0).contains(&x);
    let is_beta = |x: f64| (1e-4..=1.0).contains(&x);
    let is_chance = |x: f64| x > 0.0 && x < 1.0;
    let found = WarpedAreaOptions {
        rays: rays(table, "rays", usual.rays)?,
        kappa: kappa(table, "kappa", usual.kappa)?,
        film_px: pixels(table, "film_px", usual.film_px)?,
        exponent: table.number_if(
            "exponent",
            usual.exponent,
            "a number from 1 to 16",
            is_exponent,
        )?,
        beta: table.number_if("beta", usual.beta, "a number from 0.0001 to 1", is_beta)?,
        antithetic: table.truth("antithetic", usual.antithetic)?,
        debias: table.truth("debias", usual.debias)?,
        debias_chance: table.number_if(
            "debias_chance",
            usual.debias_chance,
            "a number between 0 and 1",
            is_chance,
        )?,
    };
    match found.antithetic && found.rays % 2 == 1 {
        true => Err(table.error(
            "rays",
            "antithetic rays come in pairs; write an even number",
        )),
        false => Ok(found),
    }
}
