//! One page with everything in it, for a browser.

use crate::study::cell::{Cell, Row};
use crate::study::chart::svg::escaped;
use crate::study::config::Plan;
use crate::study::verdict::{Kind, percent};
use base64::Engine;
use base64::engine::general_purpose::STANDARD;

/// What is shown of a direction.
pub struct Panel<'a> {
    pub row: &'a Row,
    pub svg: String,
    /// The gradient pictures as a PNG.
    pub grid: Vec<u8>,
}

const STYLE: &str = "\
body{font:16px/1.5 system-ui,sans-serif;margin:0 auto;max-width:1180px;padding:0 16px 48px;\
color:#1c1c1c;background:#fff}\
h1{font-size:1.6rem;margin:1.2em 0 .3em}h2{font-size:1.2rem;margin:0 0 .2em;overflow-wrap:anywhere}\
p{margin:.3em 0 .8em;max-width:70ch}\
section{border-top:1px solid #ddd;padding:20px 0}\
.pair{display:grid;grid-template-columns:minmax(0,1fr) minmax(0,1fr);gap:24px;align-items:start}\
@media(max-width:820px){.pair{grid-template-columns:minmax(0,1fr)}}\
svg{width:100%;height:auto;display:block}\
figure{margin:0}figure img{width:100%;max-width:700px;height:auto;display:block}\
figcaption{font-size:.85rem;color:#555}\
.scroll{overflow-x:auto}table{border-collapse:collapse;font-size:.85rem;margin:.6em 0}\
td,th{padding:3px 10px 3px 0;text-align:left;vertical-align:top;border-bottom:1px solid #eee}\
td:last-child{min-width:17rem}td.n,th.n{text-align:right;white-space:nowrap;font-variant-numeric:tabular-nums}\
.right{color:#00664a}.biased,.unstable{color:#b3261e;font-weight:600}.refused,.unknown{color:#6b5900}\
nav{columns:14em;font-size:.9rem}nav a{display:block;overflow-wrap:anywhere}";

/// The page; it asks for nothing from elsewhere.
pub fn html(plan: &Plan, summary: &str, panels: &[Panel]) -> String {
    let title = escaped(&plan.title);
    let links: Vec<String> = panels
        .iter()
        .map(|panel| format!("<a href=\"#{0}\">{0}</a>", name(panel.row)))
        .collect();
    let sections: Vec<String> = panels.iter().map(section).collect();
    format!(
        "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\
         <meta name=\"viewport\" content=\"width=device-width,initial-scale=1\">\
         <title>{title}</title><style>{STYLE}</style></head><body>\n<h1>{title}</h1>\n\
         <p>{about}</p>\n<figure class=\"scroll\">{summary}</figure>\n<nav>{links}</nav>\n{sections}\
         </body></html>\n",
        about = escaped(&plan.about),
        links = links.join(""),
        sections = sections.concat(),
    )
}

fn name(row: &Row) -> String {
    format!("{}-{}", row.scene, row.direction)
}

fn section(panel: &Panel) -> String {
    let Panel { row, svg, grid } = panel;
    let symptom = match row.symptom.as_str() {
        "" => String::new(),
        text => format!("<p>Expected: {}</p>", escaped(text)),
    };
    let lines: Vec<String> = row.cells.iter().map(line).collect();
    format!(
        "<section id=\"{id}\"><h2>{scene} · {direction}</h2>{symptom}\
         <div class=\"pair\"><div>{svg}</div>\
         <figure><img alt=\"Gradient pictures\" src=\"data:image/png;base64,{grid}\">\
         <figcaption>In about equal time</figcaption></figure></div>\
         <div class=\"scroll\"><table><tr><th>method</th><th class=\"n\">samples</th>\
         <th class=\"n\">seconds</th><th class=\"n\">rms error</th><th class=\"n\">rms bias</th>\
         <th class=\"n\">coverage</th><th class=\"n\">efficiency</th><th>verdict</th></tr>{lines}\
         </table></div></section>\n",
        id = name(row),
        scene = escaped(&row.scene),
        direction = escaped(&row.direction),
        grid = STANDARD.encode(grid),
        lines = lines.concat(),
    )
}

fn line(cell: &Cell) -> String {
    let kind = cell.verdict.kind.name();
    let text = escaped(&cell.verdict.text);
    let verdict = match cell.verdict.kind {
        Kind::Right => format!("<td class=\"{kind}\">{kind}: {text}</td>"),
        _ => format!("<td><span class=\"{kind}\">{kind}</span>: {text}</td>"),
    };
    let number =
        |value: Option<String>| format!("<td class=\"n\">{}</td>", value.unwrap_or("–".into()));
    let figures = cell.figures.as_ref();
    let times = cell.times.as_ref();
    let columns = [
        number(times.map(|t| format!("{:.3}", t.processor_seconds))),
        number(figures.map(|f| percent(f.rmse))),
        number(figures.map(|f| percent(f.bias_squared.max(0.0).sqrt()))),
        number(figures.and_then(|f| f.coverage).map(percent)),
        number(
            times
                .and_then(|t| t.relative_efficiency)
                .map(|e| format!("{e:.2}")),
        ),
    ];
    format!(
        "<tr><td>{}</td><td class=\"n\">{}</td>{}{verdict}</tr>",
        escaped(&cell.method),
        cell.spp,
        columns.concat()
    )
}
