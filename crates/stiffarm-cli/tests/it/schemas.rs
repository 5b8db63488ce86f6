//! Every key that a command prints stands in its schema, and every required one is printed.

use crate::support;

use serde_json::Value;
use support::{Folder, measurements};

#[test]
fn schemas_describe_what_the_commands_print() {
    let folder = Folder::with("simulated.csv", measurements());
    folder.ok("identify builtin:comau simulated.csv --output stiffness.json");
    folder.write("poses.csv", "x_mm,y_mm,z_mm,a_deg,b_deg,c_deg\n1800,0,1500,0,90,0\n9000,0,0,0,0,0\n");
    let lines = [
        ("result-check", "check"),
        ("result-capsules", "capsules builtin:spindle.obj --unit mm --tool"),
        ("result-evaluate", "evaluate builtin:comau builtin:comau-group1"),
        ("result-select", "select builtin:comau --initial builtin:comau-group1"),
        ("result-select", "select builtin:comau -n 2 --rounds 1 --sensitivity --anchor-box-mm 1700,0,0,1800,0,0"),
        ("result-select", "select builtin:comau --given builtin:comau-group1 --rounds 1"),
        ("result-select-drop", "select builtin:comau --given builtin:comau-group1 --drop"),
        ("result-select-curve", "select builtin:comau --curve -n 2 --rounds 1"),
        ("result-select-space-filling", "select builtin:comau --space-filling"),
        ("result-simulate", "simulate builtin:comau builtin:comau-group1 --runs 2 --levels 1"),
        ("result-simulate-elastic", "simulate builtin:comau builtin:comau-group1 --elastic mixed --runs 1"),
        ("result-register", "register builtin:example-pairs"),
        ("result-identify", "identify builtin:comau simulated.csv"),
        ("result-validate", "validate builtin:comau stiffness.json simulated.csv"),
        ("result-validate", "validate builtin:comau simulated.csv --folds 3 --extra tilt3 --estimator ordinary"),
        ("result-zones", "zones --steps 5"),
        ("result-pose", "pose builtin:comau builtin:comau-group1"),
        ("result-pose-poses", "pose builtin:comau --poses poses.csv --convention kuka"),
        (
            "result-export",
            "export builtin:comau builtin:comau-group1 --language rapid --controller abb --output-dir program",
        ),
        (
            "result-export-compare",
            "export builtin:comau builtin:comau-group1 --language rapid --controller abb --compare program/measure_comau_group1.mod",
        ),
        ("result-study", "study --runs 2 --initial-groups 2 --output-dir study"),
        ("result-study", "study --runs 1 --initial-groups 0 --elastic mixed --output-dir study-elastic"),
    ];
    for (name, line) in lines {
        let schema: Value = serde_json::from_str(&folder.ok(&format!("schema {name}"))).unwrap();
        let printed = folder.json(line);
        same_keys(&schema, &schema, &printed, name);
    }
}

/// Every key that is printed is described, and every required key is printed.
fn same_keys(root: &Value, schema: &Value, printed: &Value, at: &str) {
    if let Some(name) = schema["$ref"].as_str() {
        return same_keys(root, root.pointer(name.trim_start_matches('#')).unwrap(), printed, at);
    }
    if let Some(options) = schema["anyOf"].as_array() {
        let option = options.iter().find(|o| o["type"] != "null").unwrap();
        if !printed.is_null() {
            same_keys(root, option, printed, at);
        }
        return;
    }
    match (printed, schema["properties"].as_object()) {
        (Value::Object(object), Some(properties)) => {
            for (key, value) in object {
                let described = properties.get(key).unwrap_or_else(|| panic!("{at}.{key} is not described"));
                same_keys(root, described, value, &format!("{at}.{key}"));
            }
            let required = schema["required"].as_array().into_iter().flatten();
            for key in required.filter_map(|key| key.as_str()) {
                assert!(object.contains_key(key), "{at}.{key} is not printed");
            }
        }
        (Value::Array(items), _) => {
            for item in items {
                same_keys(root, &schema["items"], item, &format!("{at}[]"));
            }
        }
        _ => {}
    }
}
