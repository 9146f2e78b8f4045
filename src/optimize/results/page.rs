//! `index.html`: the run on one page that needs no other file, also while it goes on.

use super::curve;
use super::errors::ParameterError;
use super::text::plain;
use crate::optimize::problem::Problem;
use crate::optimize::run::state::State;
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use std::fmt::Write as _;

pub const NAME: &str = "index.html";

/// Seconds between two looks of a page whose run goes on.
const REFRESH_SECONDS: u32 = 5;

/// A picture of the page.
pub struct Figure {
    pub caption: String,
    pub png: Vec<u8>,
}

/// The file of a view's picture. Views begin with their number.
pub fn of_view(view: &str) -> String {
    format!("view-{}.png", plain(view))
}

/// Whether a file's name is one of [`of_view`]'s.
pub fn is_view(name: &str) -> bool {
    let view = name
        .strip_prefix("view-")
        .and_then(|n| n.strip_suffix(".png"));
    let number = view.and_then(|view| view.split_once('_')).map(|(n, _)| n);
    number.is_some_and(|n| !n.is_empty() && n.bytes().all(|b| b.is_ascii_digit()))
}

const STYLE: &str = "
:root{color-scheme:light dark;--ink:#1b1f24;--dim:#5b6570;--line:#d5dae0;--paper:#fff;--card:#f6f8fa}
@media(prefers-color-scheme:dark){:root{--ink:#e6e9ed;--dim:#9aa5b1;--line:#3a424c;--paper:#14171a;--card:#1c2127}}
*{box-sizing:border-box}
body{margin:0 auto;max-width:72rem;padding:1rem;font:16px/1.5 system-ui,sans-serif;color:var(--ink);background:var(--paper)}
h1{font-size:1.4rem;margin:.2rem 0}h2{font-size:1.1rem;margin:1.6rem 0 .4rem}
p.state{color:var(--dim);margin:.2rem 0 1rem}
.numbers{display:grid;grid-template-columns:repeat(auto-fit,minmax(9rem,1fr));gap:.6rem;margin:0}
.numbers div{background:var(--card);border:1px solid var(--line);border-radius:.4rem;padding:.5rem .7rem}
.numbers dt{color:var(--dim);font-size:.85rem}.numbers dd{margin:0;font-variant-numeric:tabular-nums;overflow-wrap:anywhere}
svg{min-width:30rem}svg,img{display:block;width:100%;height:auto;border:1px solid var(--line);border-radius:.3rem}
img{image-rendering:pixelated;background:#fff}
figure{margin:.8rem 0}figcaption{color:var(--dim);font-size:.9rem}
.scroll{overflow-x:auto}table{border-collapse:collapse;font-variant-numeric:tabular-nums}
th,td{text-align:left;white-space:nowrap;padding:.25rem .8rem .25rem 0;border-bottom:1px solid var(--line)}
progress{width:100%}";

/// The page. `known` are lines on meshes and views whose truth is known.
pub fn html(
    problem: &Problem,
    state: &State,
    figures: &[Figure],
    errors: &[ParameterError],
    known: &[String],
    is_running: bool,
) -> String {
    let config = &problem.config;
    let name = config
        .file
        .file_stem()
        .unwrap_or_default()
        .to_string_lossy();
    let name = escaped(&name);
    let mut text =
        String::from("<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">");
    text.push_str("<meta name=\"viewport\" content=\"width=device-width,initial-scale=1\">");
    if is_running {
        let _ = write!(
            text,
            "<meta http-equiv=\"refresh\" content=\"{REFRESH_SECONDS}\">"
        );
    }
    let _ = write!(
        text,
        "<title>{name}</title><style>{STYLE}</style></head><body><h1>{name}</h1>"
    );
    let what = match (is_running, &state.ended) {
        (true, _) => "running; this page looks again by itself".to_string(),
        (false, Some(why)) => format!("ended before the last step: {}", escaped(why)),
        (false, None) if state.step < config.steps => {
            "interrupted; --resume goes on with it".to_string()
        }
        (false, None) => "done".to_string(),
    };
    let _ = write!(text, "<p class=\"state\">{what}</p>");
    let _ = write!(
        text,
        "<progress max=\"{}\" value=\"{}\">{} of {}</progress>",
        config.steps, state.step, state.step, config.steps
    );
    numbers(problem, state, &mut text);
    text.push_str("<h2>Loss</h2><div class=\"scroll\">");
    text.push_str(&curve::svg(&state.history));
    text.push_str("</div>");
    table(problem, state, errors, &mut text);
    for line in known {
        let _ = write!(text, "<p>{}</p>", escaped(line));
    }
    if !figures.is_empty() {
        text.push_str("<h2>Pictures</h2>");
    }
    for figure in figures {
        let _ = write!(
            text,
            "<figure><img alt=\"{0}\" src=\"data:image/png;base64,{1}\"><figcaption>{0}</figcaption></figure>",
            escaped(&figure.caption),
            STANDARD.encode(&figure.png)
        );
    }
    text.push_str("</body></html>\n");
    text
}

fn numbers(problem: &Problem, state: &State, text: &mut String) {
    let last = state.history.last();
    let shown = |v: Option<f64>| v.map_or("–".into(), |v| format!("{v:.4e}"));
    let items = [
        (
            "step",
            format!("{} of {}", state.step, problem.config.steps),
        ),
        ("loss", shown(last.and_then(|r| r.loss))),
        ("± standard error", shown(last.and_then(|r| r.error))),
        ("of noise alone", shown(last.and_then(|r| r.floor))),
        (
            "samples a pixel",
            last.map_or("–".into(), |r| r.spp.to_string()),
        ),
        (
            "refused steps",
            state
                .history
                .iter()
                .filter(|r| r.refused)
                .count()
                .to_string(),
        ),
    ];
    text.push_str("<dl class=\"numbers\">");
    for (name, value) in items {
        let _ = write!(text, "<div><dt>{name}</dt><dd>{value}</dd></div>");
    }
    text.push_str("</dl>");
}

fn table(problem: &Problem, state: &State, errors: &[ParameterError], text: &mut String) {
    text.push_str(
        "<h2>Parameters</h2><div class=\"scroll\"><table><tr><th>key</th><th>now</th><th>off the known scene \
         (RMS)</th><th>at the start</th></tr>",
    );
    for (variable, values) in problem.variables.iter().zip(state.values(problem)) {
        let key = &variable.parameter.key;
        let now = match values.len() {
            0..=6 => {
                let all: Vec<String> = values.iter().map(|v| format!("{v:.4}")).collect();
                all.join(", ")
            }
            many => format!("{many} numbers"),
        };
        let (end, start) = match errors.iter().find(|e| e.key == *key) {
            Some(e) => (format!("{:.2e}", e.end), format!("{:.2e}", e.start)),
            None => ("–".into(), "–".into()),
        };
        let _ = write!(
            text,
            "<tr><td>{}</td><td>{now}</td><td>{end}</td><td>{start}</td></tr>",
            escaped(key)
        );
    }
    text.push_str("</table></div>");
}

/// As HTML has it.
fn escaped(text: &str) -> String {
    super::text::escaped(text).replace('>', "&gt;")
}
