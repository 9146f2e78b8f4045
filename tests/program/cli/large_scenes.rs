//! Scene files of a megabyte are read, or refused, in about a second, whatever is in them.

use crate::workplace::{text, warpath, workplace};
use std::time::{Duration, Instant};

/// What took a minute and more where time grew with the square.
const LIMIT: Duration = Duration::from_secs(20);

fn params(scene: &str) -> (Option<i32>, String, String) {
    let directory = workplace();
    std::fs::write(directory.path().join("large.xml"), scene).unwrap();
    let started = Instant::now();
    let out = warpath(directory.path(), &["params", "large.xml"]);
    let took = started.elapsed();
    let (said, message) = (text(&out.stdout), text(&out.stderr));
    assert!(took < LIMIT, "{took:?}: {message}");
    (out.status.code(), said, message)
}

#[test]
fn an_element_of_very_many_attributes_is_refused_at_once() {
    let attributes: String = (0..200_000).map(|i| format!(" a{i}=\"1\"")).collect();
    let (code, _, message) = params(&format!("<scene version=\"3.0.0\"{attributes}/>"));
    assert_eq!(code, Some(3), "{message}");
    assert!(
        message.contains("large.xml:1:1: an element has more than 64 attributes"),
        "{message}"
    );
}

#[test]
fn elements_nested_very_deep_are_refused_at_once() {
    let open = |i| format!("<scene version=\"3.0.0\" xmlns:a{i}=\"u{i}\">");
    let nested: String = (0..5000).map(open).collect();
    let (code, _, message) = params(&(nested + &"</scene>".repeat(5000)));
    assert_eq!(code, Some(3), "{message}");
    assert!(
        message.contains("large.xml:1:1: scenes have no namespaces"),
        "{message}"
    );
}

#[test]
fn spheres_are_remarked_on_once() {
    let sphere = "<shape type=\"sphere\"/>\n";
    let head = "<scene version=\"3.0.0\"><sensor type=\"perspective\"><float name=\"fov\" value=\"40\"/></sensor>\n";
    let (_, _, one) = params(&format!("{head}{sphere}</scene>"));
    assert!(
        one.contains("large.xml:2:1: the sphere is tessellated: an icosahedron subdivided 5 times, 20480 triangles"),
        "{one}"
    );
    let (_, _, three) = params(&format!("{head}{sphere}{sphere}{sphere}</scene>"));
    assert_eq!(three.matches("tessellated").count(), 1, "{three}");
    assert!(
        three.contains("large.xml:2:1: this sphere and 2 more are tessellated")
            && three.contains(": 61440 triangles in all"),
        "{three}"
    );
}

/// Columns are counted from the line's start, and the other names of the one colour are longer than
/// any format's width.
#[test]
fn one_line_of_very_many_elements_is_read() {
    let shapes = "<shape type=\"rectangle\"><ref id=\"grey\"/></shape>".repeat(60_000);
    let scene = format!(
        "<scene version=\"3.0.0\"><sensor type=\"perspective\"><float name=\"fov\" value=\"40\"/></sensor>\
         <bsdf type=\"diffuse\" id=\"grey\"/>{shapes}<emitter type=\"constant\"/></scene>"
    );
    let (code, said, message) = params(&scene);
    assert_eq!(code, Some(0), "{message}");
    assert!(said.contains("grey.reflectance.value"));
    assert!(said.lines().count() > 60_000);
}
