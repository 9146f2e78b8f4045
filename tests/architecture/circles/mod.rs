//! No files use each other in a circle.

mod faces;
mod graph;
mod made_up;
mod modules;

use crate::sources::of_the_crate;
use graph::Graph;
use std::collections::BTreeSet;

#[test]
fn no_files_use_each_other_in_a_circle() {
    let graph = Graph::of(&of_the_crate());
    let circles = circles(&graph);
    let told: Vec<String> = circles.iter().map(|circle| tell(&graph, circle)).collect();
    assert!(
        told.is_empty(),
        "{} circles:\n\n{}",
        told.len(),
        told.join("\n")
    );
}

/// Files of which each uses each, by way of others or not: the graph's strongly connected
/// components.
fn circles(graph: &Graph) -> Vec<BTreeSet<&str>> {
    let mut found: Vec<BTreeSet<&str>> = Vec::new();
    for file in graph.edges.keys() {
        if found.iter().any(|circle| circle.contains(file.as_str())) {
            continue;
        }
        let around = reached(graph, file)
            .into_iter()
            .filter(|other| reached(graph, other).contains(file.as_str()));
        let circle: BTreeSet<&str> = around.collect();
        if circle.len() > 1 {
            found.push(circle);
        }
    }
    found
}

/// All files that a file uses, by way of others or not.
fn reached<'a>(graph: &'a Graph, file: &str) -> BTreeSet<&'a str> {
    let mut met = BTreeSet::new();
    let mut left = vec![file];
    while let Some(file) = left.pop() {
        for other in graph
            .edges
            .get(file)
            .into_iter()
            .flat_map(|uses| uses.keys())
        {
            if met.insert(other.as_str()) {
                left.push(other);
            }
        }
    }
    met
}

/// The files of a circle, and what each takes from the others.
fn tell(graph: &Graph, circle: &BTreeSet<&str>) -> String {
    let mut told = format!("{} files:\n", circle.len());
    for file in circle {
        told += &format!("  {file}\n");
        for (other, path) in &graph.edges[*file] {
            if circle.contains(other.as_str()) {
                told += &format!("    uses {other}: {path}\n");
            }
        }
    }
    told
}
