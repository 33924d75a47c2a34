//! The binary part of a GLB: numbers appended, each run described by an accessor; and the container around both parts.

use std::collections::BTreeMap;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::ops::Range;

use gltf_json::accessor::{ComponentType, GenericComponentType, Type};
use gltf_json::buffer::{Target, View};
use gltf_json::validation::{Checked, USize64};
use gltf_json::{Accessor, Buffer, Index, Root, Value};

/// What a run of numbers is used for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Use {
    /// Vertex attribute.
    Vertices,
    /// Vertex numbers of a primitive.
    Indices,
    /// Keyframes or matrices.
    Data,
}

/// Where numbers are, and what tells of them.
type Stored = (Range<usize>, Index<Accessor>);
/// Hash of numbers, how many a row has, and whether they have bounds.
type Shape = (u64, usize, bool);

/// A glTF document in the making, with its binary part.
#[derive(Debug, Default)]
pub(super) struct Document {
    pub(super) root: Root,
    bytes: Vec<u8>,
    /// Accessors of keyframes by a hash of these, and where they are: the same keyframes are stored once.
    known: BTreeMap<Shape, Vec<Stored>>,
}

impl Document {
    /// Appends rows of `f32`, with bounds where `bounded`.
    pub(super) fn floats<const N: usize>(
        &mut self,
        rows: &[[f32; N]],
        purpose: Use,
        bounded: bool,
    ) -> Index<Accessor> {
        let bytes: Vec<u8> = rows.iter().flatten().flat_map(|number| number.to_le_bytes()).collect();
        let shared = (purpose == Use::Data).then(|| (hash_of(&bytes), N, bounded));
        let places = shared.and_then(|shape| self.known.get(&shape));
        let known = places.and_then(|places| places.iter().find(|(at, _)| self.bytes[at.clone()] == *bytes));
        if let Some((_, known)) = known {
            return *known;
        }
        let at = self.bytes.len()..self.bytes.len() + bytes.len();
        let kind = match N {
            1 => Type::Scalar,
            3 => Type::Vec3,
            4 => Type::Vec4,
            _ => Type::Mat4,
        };
        let mut accessor = self.run(&bytes, rows.len(), (ComponentType::F32, kind), purpose);
        if bounded {
            accessor.min = Some(bounds(rows, f32::min));
            accessor.max = Some(bounds(rows, f32::max));
        }
        let index = self.root.push(accessor);
        if let Some(shape) = shared {
            self.known.entry(shape).or_default().push((at, index));
        }
        index
    }

    /// Appends vertex numbers.
    pub(super) fn indices(&mut self, numbers: &[u32]) -> Index<Accessor> {
        let bytes: Vec<u8> = numbers.iter().flat_map(|number| number.to_le_bytes()).collect();
        let kind = (ComponentType::U32, Type::Scalar);
        let accessor = self.run(&bytes, numbers.len(), kind, Use::Indices);
        self.root.push(accessor)
    }

    /// Appends the joints of vertices, four each.
    pub(super) fn joints(&mut self, rows: &[[u16; 4]]) -> Index<Accessor> {
        let bytes: Vec<u8> = rows.iter().flatten().flat_map(|joint| joint.to_le_bytes()).collect();
        let kind = (ComponentType::U16, Type::Vec4);
        let accessor = self.run(&bytes, rows.len(), kind, Use::Vertices);
        self.root.push(accessor)
    }

    fn run(&mut self, bytes: &[u8], count: usize, kind: (ComponentType, Type), purpose: Use) -> Accessor {
        let view = self.root.push(View {
            buffer: Index::new(0),
            byte_length: USize64::from(bytes.len()),
            byte_offset: Some(USize64::from(self.bytes.len())),
            byte_stride: None,
            name: None,
            target: match purpose {
                Use::Vertices => Some(Checked::Valid(Target::ArrayBuffer)),
                Use::Indices => Some(Checked::Valid(Target::ElementArrayBuffer)),
                Use::Data => None,
            },
            extensions: None,
            extras: Default::default(),
        });
        // All numbers are two or four bytes long and their runs whole multiples of four bytes: offsets stay aligned.
        self.bytes.extend_from_slice(bytes);
        Accessor {
            buffer_view: Some(view),
            byte_offset: None,
            count: USize64::from(count),
            component_type: Checked::Valid(GenericComponentType(kind.0)),
            extensions: None,
            extras: Default::default(),
            type_: Checked::Valid(kind.1),
            min: None,
            max: None,
            name: None,
            normalized: false,
            sparse: None,
        }
    }

    /// The finished file.
    ///
    /// Layout: glTF 2.0 specification, §4.4 (binary container): header, JSON padded with spaces, binary padded with zeros.
    pub(super) fn into_glb(mut self) -> Vec<u8> {
        self.root.push(Buffer {
            byte_length: USize64::from(self.bytes.len()),
            name: None,
            uri: None,
            extensions: None,
            extras: Default::default(),
        });
        let mut json = self.root.to_vec().expect("plain data has a JSON form");
        json.resize(json.len().next_multiple_of(4), b' ');
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        let length = 12 + 8 + json.len() + 8 + self.bytes.len();
        let mut file = Vec::with_capacity(length);
        file.extend_from_slice(b"glTF");
        file.extend_from_slice(&2_u32.to_le_bytes());
        file.extend_from_slice(&size(length));
        for (kind, chunk) in [(b"JSON", &json), (b"BIN\0", &self.bytes)] {
            file.extend_from_slice(&size(chunk.len()));
            file.extend_from_slice(kind);
            file.extend_from_slice(chunk);
        }
        file
    }
}

/// Smallest or largest of each component, as exact decimal forms of the `f32`.
fn bounds<const N: usize>(rows: &[[f32; N]], pick: fn(f32, f32) -> f32) -> Value {
    let mut bound = rows.first().copied().unwrap_or([0.0; N]);
    for row in rows {
        bound = std::array::from_fn(|k| pick(bound[k], row[k]));
    }
    Value::from(bound.map(f64::from).to_vec())
}

fn hash_of(bytes: &[u8]) -> u64 {
    let mut hasher = DefaultHasher::new();
    bytes.hash(&mut hasher);
    hasher.finish()
}

fn size(bytes: usize) -> [u8; 4] {
    u32::try_from(bytes).expect("a GLB holds less than 4 GiB by its format").to_le_bytes()
}
