//! The JSON Schema of scene files, for editors.

use schemars::generate::SchemaSettings;
use serde_json::Value;

use crate::scene::raw;

/// JSON Schema (draft 7, which TOML editors read) of scene files, with titles and descriptions for every key.
pub fn schema() -> Value {
    let generator = SchemaSettings::draft07().into_generator();
    let mut schema = generator.into_root_schema_for::<raw::Scene>().to_value();
    title_keys(&mut schema);
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
