//! Functions with many arguments say why.

use crate::sources::all;

#[test]
fn many_arguments_have_a_reason() {
    let mut wrong = Vec::new();
    for source in all() {
        let lines: Vec<&str> = source.text.lines().map(str::trim).collect();
        for (i, line) in lines.iter().enumerate() {
            if line.starts_with('#')
                && line.contains("clippy::too_many_arguments")
                && !is_reason_beside(line)
                && !(i > 0 && is_comment(lines[i - 1]))
            {
                wrong.push(format!("{}:{}", source.path, i + 1));
            }
        }
    }
    assert!(
        wrong.is_empty(),
        "write the reason in a comment above or beside:\n{}",
        wrong.join("\n")
    );
}

/// What the function does, in `///`, is no reason.
fn is_comment(line: &str) -> bool {
    let said = line.strip_prefix("//");
    said.is_some_and(|said| !said.starts_with(['/', '!']) && !said.trim().is_empty())
}

fn is_reason_beside(line: &str) -> bool {
    line.find("//").is_some_and(|at| is_comment(&line[at..]))
}
