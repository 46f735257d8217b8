//! OctoMap's file formats: `.bt` (two bits a node) and `.ot` (full log odds).
//!
//! The `.bt` stream gives each inner node two bytes, two bits a child: 00 unknown, 01 free (low bit first), 10
//! occupied, 11 inner (Wurm, section 5.2.4); children follow depth first.

use crate::octree::map::OccupancyMap;
use crate::octree::sensor_model::SensorModel;
use crate::octree::tree::{DEPTH, Node, build, fill};

const BINARY_HEADER: &str = "# Octomap OcTree binary file";
const FULL_HEADER: &str = "# Octomap OcTree file";
const COMMENT: &str =
    "\n# (feel free to add / change comments, but leave the first line as it is!)\n#\n";

/// The map as a `.bt` file: each voxel free or occupied at the clamping thresholds, then pruned.
///
/// # Errors
/// If the map is larger than the format allows.
pub fn write_bt(map: &OccupancyMap) -> Result<Vec<u8>, String> {
    let (free, occupied) = (map.model.lowest, map.model.highest);
    let root = build(
        &map.occupancy,
        |value| if value >= 0 { occupied } else { free },
    )?;
    let mut bytes = header(BINARY_HEADER, &root, map.lattice.resolution_m);
    // A tree that is one leaf has no inner node to write; the format cannot express it.
    match &root {
        Node::Leaf(_) => return Err("a map of one single leaf cannot be written as .bt".into()),
        Node::Inner(children, _) => write_two_bits(&mut bytes, children),
        Node::Unknown => {}
    }
    Ok(bytes)
}

fn header(first_line: &str, root: &Node, resolution_m: f64) -> Vec<u8> {
    format!(
        "{first_line}{COMMENT}id OcTree\nsize {}\nres {resolution_m}\ndata\n",
        root.count()
    )
    .into_bytes()
}

fn write_two_bits(bytes: &mut Vec<u8>, children: &[Node; 8]) {
    let bits = children
        .iter()
        .enumerate()
        .fold(0u16, |bits, (number, child)| {
            let code = match child {
                Node::Unknown => 0b00,
                Node::Leaf(value) if *value < 0 => 0b01,
                Node::Leaf(_) => 0b10,
                Node::Inner(..) => 0b11,
            };
            bits | code << (2 * number)
        });
    bytes.extend(bits.to_le_bytes());
    for child in children {
        if let Node::Inner(children, _) = child {
            write_two_bits(bytes, children);
        }
    }
}

/// The map as a `.ot` file with log odds as floats.
///
/// # Errors
/// If the map is larger than the format allows.
pub fn write_ot(map: &OccupancyMap) -> Result<Vec<u8>, String> {
    let root = build(&map.occupancy, |value| value)?;
    let mut bytes = header(FULL_HEADER, &root, map.lattice.resolution_m);
    write_values(&mut bytes, &root, &map.model);
    Ok(bytes)
}

fn write_values(bytes: &mut Vec<u8>, node: &Node, model: &SensorModel) {
    let Some(value) = node.maximum() else { return };
    bytes.extend((model.log_odds(value) as f32).to_le_bytes());
    if let Node::Inner(children, _) = node {
        bytes.push(
            children
                .iter()
                .enumerate()
                .fold(0, |mask, (number, child)| {
                    mask | u8::from(*child != Node::Unknown) << number
                }),
        );
        for child in children.iter() {
            write_values(bytes, child, model);
        }
    } else {
        bytes.push(0);
    }
}

/// Reads a `.bt` or `.ot` file into at most `limit_bytes`; log odds are rounded to the model's quantum.
///
/// # Errors
/// What is wrong with the file, and at which byte.
pub fn read(
    bytes: &[u8],
    model: SensorModel,
    limit_bytes: Option<usize>,
) -> Result<OccupancyMap, String> {
    let mut reader = Reader { bytes, at: 0 };
    let first = reader.line()?;
    let binary = first.starts_with(BINARY_HEADER);
    if !binary && !first.starts_with(FULL_HEADER) {
        return Err(format!(
            "not an OctoMap file: the first line is neither {BINARY_HEADER:?} nor {FULL_HEADER:?}"
        ));
    }
    let (mut resolution_m, mut size) = (None, None);
    loop {
        let line = reader.line()?;
        let mut words = line.split_whitespace();
        match (words.next(), words.next()) {
            (Some("data"), _) => break,
            (Some("res"), Some(text)) => {
                resolution_m = text.parse::<f64>().ok().filter(|r| *r > 0.0)
            }
            (Some("size"), Some(text)) => size = text.parse::<usize>().ok(),
            (Some("id"), Some(id)) if id != "OcTree" && id != "1" => {
                return Err(format!(
                    "holds a tree of type {id}; only OcTree can be read"
                ));
            }
            _ => {}
        }
    }
    let resolution_m = resolution_m.ok_or("the header has no line `res` with a positive number")?;
    let size = size.ok_or("the header has no line `size` with a number")?;
    let mut map = OccupancyMap::new(resolution_m, model);
    map.memory_limit_bytes = limit_bytes;
    if size > 0 {
        let root = if binary {
            reader.two_bits(&model, DEPTH)?
        } else {
            reader.values(&model, DEPTH)?
        };
        fill(&mut map.occupancy, &root, limit_bytes)?;
    }
    Ok(map)
}

struct Reader<'bytes> {
    bytes: &'bytes [u8],
    at: usize,
}

impl Reader<'_> {
    fn line(&mut self) -> Result<String, String> {
        let rest = &self.bytes[self.at..];
        let end = rest
            .iter()
            .position(|&byte| byte == b'\n')
            .ok_or("not an OctoMap file: the header ends before its line `data`")?;
        self.at += end + 1;
        Ok(String::from_utf8_lossy(&rest[..end]).into_owned())
    }

    fn take<const N: usize>(&mut self) -> Result<[u8; N], String> {
        let part = self
            .bytes
            .get(self.at..self.at + N)
            .and_then(|part| part.try_into().ok());
        self.at += N;
        part.ok_or_else(|| {
            format!(
                "the file ends at byte {} in the middle of a node",
                self.bytes.len()
            )
        })
    }

    fn two_bits(&mut self, model: &SensorModel, level: u32) -> Result<Node, String> {
        if level == 0 {
            return Err(format!(
                "the tree is deeper than {DEPTH} levels at byte {}",
                self.at
            ));
        }
        let bits = u16::from_le_bytes(self.take()?);
        let mut children = [const { Node::Unknown }; 8];
        for (number, child) in children.iter_mut().enumerate() {
            *child = match bits >> (2 * number) & 0b11 {
                0b01 => Node::Leaf(model.lowest),
                0b10 => Node::Leaf(model.highest),
                _ => Node::Unknown,
            };
        }
        for (number, child) in children.iter_mut().enumerate() {
            if bits >> (2 * number) & 0b11 == 0b11 {
                *child = self.two_bits(model, level - 1)?;
            }
        }
        Ok(Node::join(children))
    }

    fn values(&mut self, model: &SensorModel, level: u32) -> Result<Node, String> {
        let value = f32::from_le_bytes(self.take()?);
        let [mask] = self.take()?;
        if mask == 0 {
            return Ok(Node::Leaf(model.stored(f64::from(value))));
        }
        if level == 0 {
            return Err(format!(
                "the tree is deeper than {DEPTH} levels at byte {}",
                self.at
            ));
        }
        let mut children = [const { Node::Unknown }; 8];
        for (number, child) in children.iter_mut().enumerate() {
            if mask >> number & 1 == 1 {
                *child = self.values(model, level - 1)?;
            }
        }
        Ok(Node::join(children))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::octree::insertion::Limits;

    fn room() -> OccupancyMap {
        let mut map = OccupancyMap::new(0.05, SensorModel::thesis());
        let beams: Vec<[f32; 3]> = (0..2000)
            .map(|i| {
                let angle = i as f32 * 0.05;
                [2.0 * angle.cos(), 3.0 * angle.sin(), i as f32 * 0.001]
            })
            .collect();
        map.insert_scan([0.0, 0.0, 0.5], &beams, &Limits::default(), 1)
            .unwrap();
        map
    }

    #[test]
    fn a_full_file_brings_every_value_back() {
        let map = room();
        let again = read(&write_ot(&map).unwrap(), map.model, None).unwrap();
        assert_eq!(again.known_voxels(None), map.known_voxels(None));
        assert_eq!(again.lattice.resolution_m, 0.05);
    }

    #[test]
    fn a_binary_file_brings_back_free_and_occupied() {
        let map = room();
        let again = read(&write_bt(&map).unwrap(), map.model, None).unwrap();
        let (voxels, values) = map.known_voxels(None);
        assert_eq!(again.known_voxels(None).0, voxels);
        for (voxel, value) in voxels.into_iter().zip(values) {
            assert_eq!(again.occupancy.value(voxel) >= 0, value >= 0);
        }
    }

    #[test]
    fn broken_files_say_what_is_wrong() {
        let model = SensorModel::thesis();
        assert!(
            read(b"nonsense\n", model, None)
                .unwrap_err()
                .contains("not an OctoMap file")
        );
        let mut bytes = write_ot(&room()).unwrap();
        bytes.truncate(bytes.len() - 3);
        assert!(
            read(&bytes, model, None)
                .unwrap_err()
                .contains("ends at byte")
        );
        let endless = [write_bt(&room()).unwrap()[..150].to_vec(), vec![0xff; 200]].concat();
        assert!(read(&endless, model, None).is_err());
        let whole = write_ot(&room()).unwrap();
        assert!(
            read(&whole, model, Some(1000))
                .unwrap_err()
                .contains("limit")
        );
    }
}
