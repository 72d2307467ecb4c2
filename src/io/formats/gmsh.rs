//! Reading Gmsh `.msh`, versions 2.2 and 4.1, ascii and binary (Gmsh reference manual, chapter 9).

use std::collections::HashMap;

use crate::io::array::{ArrayData, DataArray};
use crate::io::dataset::DataSet;
use crate::io::error::{Fault, Place, quoted};
use crate::io::lexer::Lexer;

use super::parts::{Parts, kind};

/// Gmsh's number, VTK's number and the corners of each kind of element.
pub(super) const ELEMENTS: [(i32, u8, usize); 8] = [
    (15, kind::VERTEX, 1),
    (1, kind::LINE, 2),
    (2, kind::TRIANGLE, 3),
    (3, kind::QUAD, 4),
    (4, kind::TETRAHEDRON, 4),
    (5, kind::HEXAHEDRON, 8),
    (6, kind::WEDGE, 6),
    (7, kind::PYRAMID, 5),
];

/// Names of the arrays of groups, as the program meshio has them.
const PHYSICAL: &str = "gmsh:physical";
const GEOMETRICAL: &str = "gmsh:geometrical";

struct Reader<'a> {
    lexer: Lexer<'a>,
    swapped: bool,
    /// Bytes of the numbers that count, in binary files.
    size: usize,
    parts: Parts,
    points: HashMap<u64, i64>,
    cells: HashMap<u64, usize>,
    physical: Vec<i32>,
    geometrical: Vec<i32>,
    /// By dimension and number of an entity: its physical group.
    groups: HashMap<(i32, i32), i32>,
}

/// Reads nodes, elements of first order with their groups, and the data on nodes and elements.
pub(super) fn read(bytes: &[u8]) -> Result<DataSet, Fault> {
    let mut reader = Reader {
        lexer: Lexer::new(bytes),
        swapped: false,
        size: 8,
        parts: Parts::default(),
        points: HashMap::new(),
        cells: HashMap::new(),
        physical: Vec::new(),
        geometrical: Vec::new(),
        groups: HashMap::new(),
    };
    let version = reader.head()?;
    while let Some(word) = reader.lexer.word() {
        let Some(section) = word.strip_prefix(b"$") else {
            let found = quoted(&String::from_utf8_lossy(word));
            return Err(reader.lexer.fault(found, "a section such as $Nodes"));
        };
        reader.lexer.line();
        match (section, version) {
            (b"Entities", 4) => reader.entities()?,
            (b"Nodes", 4) => reader.nodes_4()?,
            (b"Nodes", _) => reader.nodes_2()?,
            (b"Elements", 4) => reader.elements_4()?,
            (b"Elements", _) => reader.elements_2()?,
            (b"NodeData", _) => reader.data(false)?,
            (b"ElementData", _) => reader.data(true)?,
            _ => {}
        }
        reader.skip_to_end_of(section)?;
    }
    reader.finish()
}

impl Reader<'_> {
    /// `$MeshFormat`: the major version.
    fn head(&mut self) -> Result<u32, Fault> {
        let expected = "$MeshFormat of Gmsh";
        let word = self.lexer.text(expected)?;
        if word != "$MeshFormat" {
            return Err(self.lexer.fault(quoted(word), expected));
        }
        let version: f64 = self.lexer.number("a version")?;
        let mode: u32 = self.lexer.number("0 (ascii) or 1 (binary)")?;
        self.size = self.lexer.number("the size of a number")?;
        if version != 4.1 && !(2.0..3.0).contains(&version) {
            return Err(Fault::unsupported(self.lexer.place(), format!("version {version} of .msh"), "2.2 or 4.1"));
        }
        if mode > 1 || !matches!(self.size, 4 | 8) {
            let found = format!("file type {mode} and data size {}", self.size);
            return Err(self.lexer.fault(found, "type 0 or 1 and size 4 or 8"));
        }
        self.lexer.line();
        self.lexer.binary = mode == 1;
        if self.lexer.binary {
            let one = self.lexer.take(4)?;
            self.swapped = match one {
                [1, 0, 0, 0] => false,
                [0, 0, 0, 1] => true,
                other => return Err(self.lexer.fault(format!("{other:?}"), "the integer one in either byte order")),
            };
        }
        self.skip_to_end_of(b"MeshFormat")?;
        Ok(if version > 3.0 { 4 } else { 2 })
    }

    fn skip_to_end_of(&mut self, section: &[u8]) -> Result<(), Fault> {
        while !self.lexer.is_at_end() {
            let line = self.lexer.line().trim_ascii();
            if line.strip_prefix(b"$End") == Some(section) {
                return Ok(());
            }
        }
        let name = String::from_utf8_lossy(section).into_owned();
        Err(self.lexer.fault("the end of the file", format!("$End{name}")))
    }

    fn bytes<const N: usize>(&mut self) -> Result<[u8; N], Fault> {
        let mut taken: [u8; N] = [0; N];
        taken.copy_from_slice(self.lexer.take(N)?);
        if self.swapped {
            taken.reverse();
        }
        Ok(taken)
    }

    fn int(&mut self, expected: &str) -> Result<i32, Fault> {
        if self.lexer.binary { Ok(i32::from_le_bytes(self.bytes()?)) } else { self.lexer.number(expected) }
    }

    fn real(&mut self, expected: &str) -> Result<f64, Fault> {
        if self.lexer.binary { Ok(f64::from_le_bytes(self.bytes()?)) } else { self.lexer.number(expected) }
    }

    /// `size_t` of version 4.
    fn number(&mut self, expected: &str) -> Result<u64, Fault> {
        match (self.lexer.binary, self.size) {
            (false, _) => self.lexer.number(expected),
            (true, 4) => Ok(u32::from_le_bytes(self.bytes()?).into()),
            (true, _) => Ok(u64::from_le_bytes(self.bytes()?)),
        }
    }

    /// A number of entries, each of at least two bytes.
    fn count(&mut self, found: u64) -> Result<usize, Fault> {
        let count = usize::try_from(found).unwrap_or(usize::MAX);
        if count > self.lexer.remaining() {
            return Err(self.lexer.fault(format!("{count} entries in {} bytes", self.lexer.remaining()), "as many as there are"));
        }
        Ok(count)
    }

    fn counted(&mut self, expected: &str) -> Result<usize, Fault> {
        let found = self.number(expected)?;
        self.count(found)
    }

    fn add_point(&mut self, tag: u64, place: [f64; 3]) -> Result<(), Fault> {
        let index = self.parts.point_count() as i64;
        if self.points.insert(tag, index).is_some() {
            return Err(self.lexer.fault(format!("node {tag} twice"), "every node once"));
        }
        self.parts.points.extend(place);
        Ok(())
    }

    fn place(&mut self) -> Result<[f64; 3], Fault> {
        Ok([self.real("a coordinate")?, self.real("a coordinate")?, self.real("a coordinate")?])
    }

    fn nodes_2(&mut self) -> Result<(), Fault> {
        let count: u64 = self.lexer.number("a number of nodes")?;
        let count = self.count(count)?;
        if self.lexer.binary {
            self.lexer.line();
        }
        for _ in 0..count {
            let tag = self.int("the number of a node")?;
            let place = self.place()?;
            self.add_point(tag as u64, place)?;
        }
        Ok(())
    }

    fn nodes_4(&mut self) -> Result<(), Fault> {
        let blocks = self.counted("a number of blocks")?;
        for _ in 0..3 {
            self.number("a number of nodes")?;
        }
        for _ in 0..blocks {
            let dimension = self.int("the dimension of an entity")?;
            self.int("the number of an entity")?;
            let is_parametric = self.int("0 or 1")? != 0;
            let count = self.counted("a number of nodes")?;
            let tags = (0..count).map(|_| self.number("the number of a node")).collect::<Result<Vec<u64>, Fault>>()?;
            for tag in tags {
                let place = self.place()?;
                for _ in 0..if is_parametric { dimension.clamp(0, 3) } else { 0 } {
                    self.real("a parameter")?;
                }
                self.add_point(tag, place)?;
            }
        }
        Ok(())
    }

    fn shape(&self, element: i32) -> Result<(u8, usize), Fault> {
        let known = ELEMENTS.iter().find(|known| known.0 == element);
        known.map(|&(_, kind, corners)| (kind, corners)).ok_or_else(|| {
            let found = format!("elements of Gmsh's kind {element}");
            Fault::unsupported(self.lexer.place(), found, "elements of first order")
        })
    }

    fn add_cell(&mut self, tag: u64, kind: u8, nodes: &[u64]) -> Result<(), Fault> {
        for node in nodes {
            let Some(&point) = self.points.get(node) else {
                return Err(self.lexer.fault(format!("node {node}"), "a node of $Nodes"));
            };
            self.parts.cells.connectivity.push(point);
        }
        self.parts.cells.offsets.push(self.parts.cells.connectivity.len() as i64);
        self.cells.insert(tag, self.parts.types.len());
        self.parts.types.push(kind);
        Ok(())
    }

    fn elements_2(&mut self) -> Result<(), Fault> {
        let count: u64 = self.lexer.number("a number of elements")?;
        let count = self.count(count)?;
        if self.lexer.binary {
            self.lexer.line();
        }
        let mut done = 0;
        while done < count {
            // Binary files have a head for a run of elements, ascii files a head each with the number in front.
            let (mut tag, element, run, tags);
            if self.lexer.binary {
                (tag, element, run, tags) = (0, self.int("a kind")?, self.int("a number")?, self.int("a number of tags")?);
            } else {
                (tag, element, run, tags) = (self.int("the number of an element")?, self.int("a kind")?, 1, self.int("a number of tags")?);
            }
            let (kind, corners) = self.shape(element)?;
            if run < 1 || tags < 0 {
                return Err(self.lexer.fault(format!("a run of {run} elements with {tags} tags"), "at least one, and no fewer than 0"));
            }
            for _ in 0..run {
                if self.lexer.binary {
                    tag = self.int("the number of an element")?;
                }
                let mut groups = [0; 2];
                for place in 0..tags {
                    let group = self.int("a tag")?;
                    if let Some(slot) = groups.get_mut(place as usize) {
                        *slot = group;
                    }
                }
                let mut nodes = [0u64; 8];
                for node in &mut nodes[..corners] {
                    *node = self.int("the number of a node")? as u64;
                }
                self.add_cell(tag as u64, kind, &nodes[..corners])?;
                self.physical.push(groups[0]);
                self.geometrical.push(groups[1]);
                done += 1;
            }
        }
        Ok(())
    }

    fn elements_4(&mut self) -> Result<(), Fault> {
        let blocks = self.counted("a number of blocks")?;
        for _ in 0..3 {
            self.number("a number of elements")?;
        }
        for _ in 0..blocks {
            let dimension = self.int("the dimension of an entity")?;
            let entity = self.int("the number of an entity")?;
            let element = self.int("a kind")?;
            let (kind, corners) = self.shape(element)?;
            let group = self.groups.get(&(dimension, entity)).copied().unwrap_or(0);
            for _ in 0..self.counted("a number of elements")? {
                let tag = self.number("the number of an element")?;
                let mut nodes = [0u64; 8];
                for node in &mut nodes[..corners] {
                    *node = self.number("the number of a node")?;
                }
                self.add_cell(tag, kind, &nodes[..corners])?;
                self.physical.push(group);
                self.geometrical.push(entity);
            }
        }
        Ok(())
    }

    /// The physical group of every entity.
    fn entities(&mut self) -> Result<(), Fault> {
        let mut counts = [0; 4];
        for count in &mut counts {
            *count = self.counted("a number of entities")?;
        }
        for (dimension, count) in counts.into_iter().enumerate() {
            for _ in 0..count {
                let entity = self.int("the number of an entity")?;
                for _ in 0..if dimension == 0 { 3 } else { 6 } {
                    self.real("a coordinate")?;
                }
                for place in 0..self.counted("a number of groups")? {
                    let group = self.int("a group")?;
                    if place == 0 {
                        self.groups.insert((dimension as i32, entity), group);
                    }
                }
                if dimension > 0 {
                    for _ in 0..self.counted("a number of entities")? {
                        self.int("the number of an entity")?;
                    }
                }
            }
        }
        Ok(())
    }

    /// `$NodeData` and `$ElementData`: texts, reals, integers, then a tuple an entry. What has no tuple is NaN.
    fn data(&mut self, of_cells: bool) -> Result<(), Fault> {
        let texts: usize = self.lexer.number("a number of texts")?;
        self.lexer.line();
        let mut name = String::from("data");
        for place in 0..texts {
            if self.lexer.is_at_end() {
                return Err(self.lexer.fault("the end of the file", "a text"));
            }
            let text = String::from_utf8_lossy(self.lexer.line()).trim().trim_matches('"').to_owned();
            if place == 0 {
                name = text;
            }
        }
        let reals: usize = self.lexer.number("a number of reals")?;
        for _ in 0..reals {
            self.lexer.number::<f64>("a real")?;
        }
        let integers: usize = self.lexer.number("a number of integers")?;
        let mut head = [0usize; 3];
        for place in 0..integers {
            let value: usize = self.lexer.number("an integer")?;
            if let Some(slot) = head.get_mut(place) {
                *slot = value;
            }
        }
        let [_, components, count] = head;
        if !(1..=9).contains(&components) {
            return Err(self.lexer.fault(format!("{components} components"), "1 to 9"));
        }
        let count = self.count(count as u64)?;
        if self.lexer.binary {
            self.lexer.line();
        }
        let tuples = if of_cells { self.parts.types.len() } else { self.parts.point_count() };
        let mut values = vec![f64::NAN; tuples * components];
        for _ in 0..count {
            let tag = self.int("the number of a node or element")? as u64;
            let known = if of_cells { self.cells.get(&tag).copied() } else { self.points.get(&tag).map(|&point| point as usize) };
            let Some(index) = known else {
                return Err(self.lexer.fault(format!("data of number {tag}"), "a node or element of the file"));
            };
            for component in 0..components {
                values[index * components + component] = self.real("a value")?;
            }
        }
        let array = DataArray::new(name, components, ArrayData::F64(values));
        if of_cells { self.parts.cell_arrays.push(array) } else { self.parts.point_arrays.push(array) }
        Ok(())
    }

    fn finish(mut self) -> Result<DataSet, Fault> {
        if self.parts.point_count() == 0 {
            return Err(Fault::new(Place::File, "no $Nodes", "the points of a Gmsh .msh file"));
        }
        for (name, groups) in [(GEOMETRICAL, self.geometrical), (PHYSICAL, self.physical)] {
            if groups.iter().any(|&group| group != 0) {
                self.parts.cell_arrays.insert(0, DataArray::new(name, 1, ArrayData::I32(groups)));
            }
        }
        Ok(self.parts.into_unstructured())
    }
}
