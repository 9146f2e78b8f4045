//! `study.json` and `study.csv`.

use crate::jobs::failure::Failure;
use crate::study::cell::Row;
use crate::study::config::Plan;
use serde_json::json;

/// All that was found. What a second run would find otherwise stands under `times` alone.
pub fn json(plan: &Plan, rows: &[Row]) -> Result<String, Failure> {
    let all = json!({
        "version": env!("CARGO_PKG_VERSION"),
        "title": plan.title,
        "about": plan.about,
        "seed": plan.seed,
        "rows": rows,
    });
    let text = serde_json::to_string_pretty(&all);
    Ok(text.map_err(|error| Failure::System(error.to_string()))? + "\n")
}

/// The same a line a cell, the columns of times last.
pub fn csv(rows: &[Row]) -> String {
    let mut text = String::from(COLUMNS);
    for (row, cell) in rows
        .iter()
        .flat_map(|row| row.cells.iter().map(move |c| (row, c)))
    {
        let f = cell.figures.clone();
        let t = cell.times.clone();
        let figure =
            |of: fn(&crate::study::quantities::Figures) -> Option<f64>| f.as_ref().and_then(of);
        let time = |of: fn(&crate::study::cell::Times) -> Option<f64>| t.as_ref().and_then(of);
        let numbers = [
            row.reference.rms,
            Some(row.reference.noise),
            figure(|f| Some(f.rmse)),
            figure(|f| Some(f.sd)),
            figure(|f| Some(f.bias_squared)),
            figure(|f| Some(f.bias_squared_se)),
            figure(|f| f.size_bias),
            figure(|f| f.size_bias_se),
            figure(|f| Some(f.bias_sigmas)),
            figure(|f| f.kurtosis),
            figure(|f| f.top_gradient_share),
            figure(|f| f.top_variance_share),
            figure(|f| f.worst_repeat_share),
            figure(|f| f.coverage),
            figure(|f| Some(f.not_finite as f64)),
            figure(|f| Some(f.rays)),
            figure(|f| Some(f.rejected_share)),
            time(|t| Some(t.seconds)),
            time(|t| Some(t.processor_seconds)),
            time(|t| t.memory_bytes.map(|bytes| bytes as f64)),
            time(|t| t.efficiency),
            time(|t| t.relative_efficiency),
            time(|t| t.relative_noise),
        ];
        let names = [&row.scene, &row.direction, &cell.method];
        let mut fields: Vec<String> = names.map(|name| name.to_string()).into();
        fields.extend([cell.spp.to_string(), cell.repeats.to_string()]);
        fields.push(cell.verdict.kind.name().into());
        fields.extend(numbers.map(|n| n.map_or(String::new(), |n| n.to_string())));
        // Names and words hold no commas.
        text += &(fields.join(",") + "\n");
    }
    text
}

const COLUMNS: &str = "scene,direction,method,spp,repeats,verdict,reference_rms,reference_noise,\
rmse,sd,bias_squared,bias_squared_se,size_bias,size_bias_se,bias_sigmas,kurtosis,\
top_gradient_share,top_variance_share,worst_repeat_share,coverage,not_finite,rays,rejected_share,\
seconds,processor_seconds,memory_bytes,efficiency,relative_efficiency,relative_noise\n";
