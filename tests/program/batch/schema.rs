//! The schema that is shipped is that of the code.

use crate::jobs::run;
use crate::workplace::workplace;

#[test]
fn the_schema_file_is_what_the_program_reads() {
    let directory = workplace();
    let printed = run(directory.path(), "batch --schema", 0).stdout;
    let shipped = std::fs::read_to_string("docs/batch.schema.json").unwrap();
    assert_eq!(
        String::from_utf8(printed).unwrap(),
        shipped,
        "write it anew: warpath batch --schema > docs/batch.schema.json"
    );
}

#[test]
fn every_field_is_documented() {
    let schema = std::fs::read_to_string("docs/batch.schema.json").unwrap();
    let schema: serde_json::Value = serde_json::from_str(&schema).unwrap();
    let page = std::fs::read_to_string("docs/batch.md").unwrap();
    for field in schema["properties"].as_object().unwrap().keys() {
        assert!(
            page.contains(&format!("| `{field}`")),
            "docs/batch.md does not tell of {field}"
        );
    }
    assert_eq!(schema["additionalProperties"], false);
}
