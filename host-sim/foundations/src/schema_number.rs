//! The number `schema` of JSON files: docs/reference/versions.md.

use std::borrow::Cow;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::{Serialize, Serializer};

/// The field `schema` of a JSON file, which always has the value `N`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SchemaNumber<const N: u32>;

impl<const N: u32> Serialize for SchemaNumber<N> {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        to.serialize_u32(N)
    }
}

impl<const N: u32> JsonSchema for SchemaNumber<N> {
    fn inline_schema() -> bool {
        true
    }

    fn schema_name() -> Cow<'static, str> {
        format!("SchemaNumber{N}").into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({"const": N})
    }
}
