//! The JSON Schema of scene files, for editors.

use schemars::generate::SchemaSettings;
use serde_json::Value;

use crate::scene::raw;

/// JSON Schema (draft 7, which TOML editors read) of scene files, with titles and descriptions for every key.
pub fn schema() -> Value {
    let generator = SchemaSettings::draft07().into_generator();
    let mut schema = generator.into_root_schema_for::<raw::Scene>().to_value();
    title_keys(&mut schema);
    schema["title"] = Value::from("Cotillion scene");
    schema
}

/// Gives every key its name, in words, as title.
fn title_keys(schema: &mut Value) {
    match schema {
        Value::Object(object) => {
            if let Some(Value::Object(properties)) = object.get_mut("properties") {
                for (key, property) in properties {
                    if let Value::Object(property) = property {
                        let title = Value::String(key.replace('_', " "));
                        property.entry("title").or_insert(title);
                    }
                }
            }
            object.values_mut().for_each(title_keys);
        }
        Value::Array(values) => values.iter_mut().for_each(title_keys),
        _ => {}
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use schemars::JsonSchema;
    use toml::de::{DeTable, DeValue};

    use super::*;
    use crate::scene::report::{Place, Report};
    use crate::scene::tree::{Node, Read};
    use crate::scene::{manipulation, physics_table, things};

    /// A scene with every kind of table.
    const EXAMPLE: &str = include_str!("example.toml");

    /// Faults that the reader of `T` finds in the table `text`.
    fn faults<T: Read>(text: &str) -> Vec<(String, String)> {
        let table = DeTable::parse(text).expect("the tests write TOML").into_inner();
        let table = DeValue::Table(table);
        let mut report = Report::default();
        let _ = T::read(&Node { value: &table, place: Place::default() }, &mut report);
        let (faults, _) = report.finish("", text);
        let parts = faults.into_iter().map(|fault| (fault.message, fault.help.unwrap_or_default()));
        parts.collect()
    }

    /// The parts of `text` in quotes.
    fn quoted(text: &str) -> BTreeSet<String> {
        text.split('"').skip(1).step_by(2).map(str::to_owned).collect()
    }

    /// Asserts that the reader and the schema of a table know the same keys and require the same ones.
    fn agree<T: Read + JsonSchema>() {
        let schema = SchemaSettings::draft07().into_generator().into_root_schema_for::<T>().to_value();
        let keys: BTreeSet<_> =
            schema["properties"].as_object().into_iter().flat_map(|keys| keys.keys().cloned()).collect();
        let required: BTreeSet<_> = schema["required"]
            .as_array()
            .into_iter()
            .flatten()
            .filter_map(|key| key.as_str().map(str::to_owned))
            .collect();
        let (missing, unknown): (Vec<_>, Vec<_>) =
            faults::<T>("zzzzzz = 1").into_iter().partition(|(message, _)| message.ends_with("is missing"));
        let asked: BTreeSet<_> = missing.iter().flat_map(|(message, _)| quoted(message)).collect();
        assert_eq!(quoted(&unknown[0].1), keys, "keys of {}", T::schema_name());
        assert_eq!(asked, required, "required keys of {}", T::schema_name());
        assert_eq!(schema["additionalProperties"], Value::Bool(false));
    }

    #[test]
    fn schema_and_reader_know_the_same_keys() {
        agree::<raw::Scene>();
        agree::<raw::FileClip>();
        agree::<raw::Contact>();
        agree::<raw::Character>();
        agree::<things::Object>();
        agree::<raw::Pin>();
        agree::<raw::Relative>();
        agree::<raw::Time>();
        agree::<raw::Duration>();
        agree::<raw::Sync>();
        agree::<raw::Warp>();
        agree::<things::ObjectKey>();
        agree::<things::Carry>();
        agree::<things::EndEffector>();
        agree::<things::Target>();
        agree::<manipulation::Drag>();
        agree::<manipulation::Discrete>();
        agree::<physics_table::Physics>();
        agree::<physics_table::Step>();
        agree::<things::FullBody>();
    }

    #[test]
    fn the_example_reads_without_structural_faults() {
        assert_eq!(faults::<raw::Scene>(EXAMPLE), []);
    }

    #[test]
    fn every_key_has_a_title_and_a_description() {
        fn visit(value: &Value) {
            if let Some(Value::Object(keys)) = value.get("properties") {
                for (key, property) in keys {
                    assert!(property["title"].is_string(), "{key} has no title");
                    assert!(property["description"].is_string(), "{key} has no description");
                }
            }
            match value {
                Value::Object(object) => object.values().for_each(visit),
                Value::Array(values) => values.iter().for_each(visit),
                _ => {}
            }
        }
        let schema = schema();
        assert!(schema.get("$id").is_none());
        assert!(schema["$schema"].is_string() && schema["description"].is_string());
        assert_eq!(schema["title"], "Cotillion scene");
        visit(&schema);
    }

    /// Whether `value` fits `schema`, for the keywords that the schema of scenes uses.
    fn fits(value: &Value, schema: &Value, root: &Value) -> bool {
        let Some(schema) = schema.as_object() else {
            return schema != &Value::Bool(false);
        };
        schema.iter().all(|(keyword, rule)| match keyword.as_str() {
            "$ref" => {
                let path = rule.as_str().unwrap_or_default().trim_start_matches('#');
                root.pointer(path).is_some_and(|target| fits(value, target, root))
            }
            "anyOf" | "oneOf" => rule.as_array().into_iter().flatten().any(|rule| fits(value, rule, root)),
            "allOf" => rule.as_array().into_iter().flatten().all(|rule| fits(value, rule, root)),
            "type" => match rule.as_str() {
                Some("object") => value.is_object(),
                Some("array") => value.is_array(),
                Some("string") => value.is_string(),
                Some("number") => value.is_number(),
                Some("integer") => value.is_u64() || value.is_i64(),
                Some("boolean") => value.is_boolean(),
                _ => panic!("unknown type {rule}"),
            },
            "enum" => rule.as_array().is_some_and(|choices| choices.contains(value)),
            "const" => rule == value,
            "required" => rule
                .as_array()
                .into_iter()
                .flatten()
                .all(|key| value.get(key.as_str().unwrap_or_default()).is_some()),
            "properties" => value
                .as_object()
                .into_iter()
                .flatten()
                .all(|(key, value)| rule.get(key).is_none_or(|rule| fits(value, rule, root))),
            "additionalProperties" => {
                let known =
                    |key: &str| schema.get("properties").is_some_and(|known| known.get(key).is_some());
                value
                    .as_object()
                    .into_iter()
                    .flatten()
                    .filter(|(key, _)| !known(key))
                    .all(|(_, value)| fits(value, rule, root))
            }
            "items" => value.as_array().into_iter().flatten().all(|value| fits(value, rule, root)),
            "minItems" => {
                value.as_array().is_none_or(|values| values.len() as u64 >= rule.as_u64().unwrap_or(0))
            }
            "maxItems" => {
                value.as_array().is_none_or(|values| values.len() as u64 <= rule.as_u64().unwrap_or(0))
            }
            _ => true,
        })
    }

    #[test]
    fn the_example_fits_the_schema_and_spoiled_ones_do_not() {
        let schema = schema();
        let fits_schema = |text: &str| {
            let table: toml::Table = toml::from_str(text).expect("the tests write TOML");
            fits(&serde_json::to_value(table).expect("a scene has no NaN"), &schema, &schema)
        };
        assert!(fits_schema(EXAMPLE));
        assert!(!fits_schema(&EXAMPLE.replace("joint = \"right_hand\"\ntarget", "target")));
        assert!(!fits_schema(&EXAMPLE.replace("moments =", "momments =")));
        assert!(!fits_schema(&EXAMPLE.replace("strength = \"hard\"", "strength = \"soft\"")));
        assert!(!fits_schema(&EXAMPLE.replace("[-3.0, 0.0]", "[-3.0, 0.0, 1.0]")));
    }
}
