//! Several data sets under one name: the steps of a .pvd file, the blocks of a .vtm file, files that fit a pattern.

use std::ffi::OsString;
use std::path::{Path, PathBuf};

use morsmooth::io::{Collection, CollectionKind, PendingFile, is_same_file, write_collection};

use crate::common::pattern::matching;
use crate::failure::Failure;

/// Lists within lists: steps of blocks of blocks. More are a list that leads back to itself.
const DEPTH: usize = 8;

/// One data set of several.
#[derive(Debug, Clone)]
pub struct Step {
    /// What it is called in messages: "step 3 (time 0.5, in_3.vti)".
    pub label: String,
    /// Its address: numbers of steps, names of blocks, parted by `/`.
    pub address: String,
    /// Its time, if a list tells one.
    pub time: Option<f64>,
    /// Its file.
    pub input: PathBuf,
    /// The file to write, without the extension, which is that of its kind of data set.
    pub stem: PathBuf,
}

/// What a list names.
#[derive(Debug, Clone, Copy)]
enum Member {
    Step(usize),
    List(usize),
}

/// A list of data sets and lists.
#[derive(Debug)]
struct List {
    /// Absent for files that fit a pattern.
    collection: Option<Collection>,
    /// The file to write.
    output: PathBuf,
    members: Vec<Member>,
}

/// All data sets behind a name, in lists.
#[derive(Debug)]
pub struct Series {
    /// How they stand to each other.
    pub kind: CollectionKind,
    /// In the order of the lists, whatever their depth.
    pub steps: Vec<Step>,
    /// Addresses of blocks without a file.
    pub empty: Vec<String>,
    /// The first is the outermost; every other one stands behind the one that names it.
    lists: Vec<List>,
}

/// Where a list stands among the others.
struct Place<'a> {
    address: &'a str,
    time: Option<f64>,
    output: PathBuf,
    depth: usize,
}

impl Series {
    /// The data sets behind an input, if it stands for several; `None` for one data set with an output for one.
    pub fn find(input: &Path, output: &Path) -> Result<Option<Self>, Failure> {
        let place = Place { address: "", time: None, output: output.to_owned(), depth: 0 };
        if let Some(files) = matching(input, &crate::common::journal::files(output))? {
            if extension(output) != "pvd" {
                let text = format!("found {} files that fit {}; expected an output ending in .pvd", files.len(), input.display());
                return Err(Failure::file(output, text));
            }
            let mut series = Self::empty(CollectionKind::Steps);
            series.add_list(None, files.into_iter().enumerate().map(|(number, file)| (number.to_string(), None, file)).collect(), &place)?;
            return Ok(Some(series));
        }
        if !input.is_file() {
            return Ok(None);
        }
        let is_list = ["pvd", "vtm", "vtpc", "vtpd"].contains(&extension(output).as_str());
        let Some(collection) = read_list(input)? else {
            return match is_list {
                false => Ok(None),
                true => Err(Failure::file(output, format!("the input {} is one data set; expected an output of its own kind", input.display()))
                    .hint("a series is a .pvd file, or a pattern in quotes such as 'step_*.vti'")),
            };
        };
        let (what, fitting) = match collection.kind {
            CollectionKind::Steps => ("time steps", "pvd".to_owned()),
            CollectionKind::Blocks => ("blocks", extension(input)),
        };
        if extension(output) != fitting {
            if collection.entries.len() == 1 && collection.empty.is_empty() && !is_list {
                return Ok(None);
            }
            let text = format!(
                "found a name for one data set, where {} holds {} {what}; expected a name ending in .{fitting}",
                input.display(),
                collection.entries.len()
            );
            return Err(Failure::file(output, text).hint(format!("{}/{} is one of them", input.display(), collection.entries[0].address)));
        }
        Self::of_collection(collection, &place).map(Some)
    }

    /// The data sets that a file lists, for looking at them; `None` for one data set.
    pub fn listed(input: &Path) -> Result<Option<Self>, Failure> {
        if !input.is_file() {
            return Ok(None);
        }
        let place = Place { address: "", time: None, output: PathBuf::new(), depth: 0 };
        read_list(input)?.map(|collection| Self::of_collection(collection, &place)).transpose()
    }

    fn empty(kind: CollectionKind) -> Self {
        Self { kind, steps: Vec::new(), empty: Vec::new(), lists: Vec::new() }
    }

    fn of_collection(collection: Collection, place: &Place<'_>) -> Result<Self, Failure> {
        let mut series = Self::empty(collection.kind);
        series.add_collection(collection, place)?;
        Ok(series)
    }

    fn add_collection(&mut self, collection: Collection, place: &Place<'_>) -> Result<usize, Failure> {
        self.empty.extend(collection.empty.iter().map(|empty| below(place.address, empty)));
        let files = collection.entries.iter().map(|entry| (entry.address.clone(), entry.time, entry.path.clone())).collect();
        self.add_list(Some(collection), files, place)
    }

    fn add_list(
        &mut self,
        collection: Option<Collection>,
        files: Vec<(String, Option<f64>, PathBuf)>,
        place: &Place<'_>,
    ) -> Result<usize, Failure> {
        let own = self.lists.len();
        self.lists.push(List { collection, output: place.output.clone(), members: Vec::new() });
        let digits = files.len().saturating_sub(1).to_string().len().max(4);
        for (number, (address, time, input)) in files.into_iter().enumerate() {
            let mut stem = place.output.file_stem().map(OsString::from).unwrap_or_default();
            stem.push(format!("_{number:0digits$}"));
            let stem = place.output.with_file_name(stem);
            let (address, time) = (below(place.address, &address), time.or(place.time));
            // What is wrong with a file is said when it is its turn.
            let inner = if place.depth < DEPTH { read_list(&input).unwrap_or(None) } else { None };
            let member = match inner {
                Some(inner) => {
                    let output = with_extension(&stem, &extension(&input));
                    Member::List(self.add_collection(inner, &Place { address: &address, time, output, depth: place.depth + 1 })?)
                }
                None => {
                    let label = self.label(&address, time, &input);
                    self.steps.push(Step { label, address, time, input, stem });
                    Member::Step(self.steps.len() - 1)
                }
            };
            self.lists[own].members.push(member);
        }
        Ok(own)
    }

    fn label(&self, address: &str, time: Option<f64>, input: &Path) -> String {
        let time = time.map_or(String::new(), |time| format!("time {time}, "));
        match self.kind {
            CollectionKind::Steps => format!("step {address} ({time}{})", input.display()),
            CollectionKind::Blocks => format!("block {address} ({})", input.display()),
        }
    }

    /// What its data sets are called.
    pub fn noun(&self) -> &'static str {
        match self.kind {
            CollectionKind::Steps => "steps",
            CollectionKind::Blocks => "blocks",
        }
    }

    /// Refuses outputs that would overwrite a file of the run.
    pub fn check(&self, output: &Path, others: &[Option<&Path>]) -> Result<(), Failure> {
        for other in others.iter().flatten() {
            if self.would_take(other) {
                return Err(Failure::file(other, "one of the files written would overwrite this one; expected another output"));
            }
        }
        for step in &self.steps {
            if is_same_file(&step.input, output) || self.would_take(&step.input) {
                let text = format!("the files written beside {} would overwrite it; expected another output", output.display());
                return Err(Failure::file(&step.input, text));
            }
        }
        Ok(())
    }

    /// Whether a file would be overwritten, whatever kind of data set will be written.
    fn would_take(&self, file: &Path) -> bool {
        let folder = |path: &Path| match path.parent() {
            Some(folder) if !folder.as_os_str().is_empty() => folder.canonicalize().ok(),
            _ => Path::new(".").canonicalize().ok(),
        };
        let stems = self.steps.iter().map(|step| step.stem.clone()).chain(self.lists.iter().skip(1).map(|list| list.output.with_extension("")));
        let Some(first) = self.lists.first() else { return false };
        if folder(file).is_none() || folder(file) != folder(&first.output) {
            return false;
        }
        let own = file.with_extension("");
        let mut names = stems.map(|stem| stem.file_name().map(OsString::from));
        names.any(|name| name.as_deref() == own.file_name())
    }

    /// Writes every list beside its place, inner ones first.
    ///
    /// # Arguments
    /// * `files`: one a step, absent for one that failed; `times`: one a step, for files that fit a pattern.
    ///
    /// # Returns
    /// The lists that name anything.
    pub fn write(&self, files: &[Option<PathBuf>], times: &[f64]) -> Result<Vec<PendingFile>, Failure> {
        let mut pending = Vec::new();
        let mut written: Vec<Option<PathBuf>> = vec![None; self.lists.len()];
        for (number, list) in self.lists.iter().enumerate().rev() {
            let file = |member: &Member| match *member {
                Member::Step(step) => files[step].as_ref(),
                Member::List(list) => written[list].as_ref(),
            };
            let name = |path: &PathBuf| path.file_name().map(|name| name.to_string_lossy().into_owned());
            let names: Vec<Option<String>> = list.members.iter().map(|member| file(member).and_then(name)).collect();
            if names.iter().all(Option::is_none) {
                continue;
            }
            let one = match &list.collection {
                Some(collection) => collection.write_temporary(&list.output, &names),
                None => {
                    let time = |member: &Member| times.get(self.first_step(*member)).copied().unwrap_or_default();
                    let entries: Vec<(f64, String)> =
                        list.members.iter().zip(names).filter_map(|(member, name)| Some((time(member), name?))).collect();
                    write_collection(&list.output, &entries)
                }
            };
            pending.push(one.map_err(|error| Failure::usage(error.to_string()))?);
            written[number] = Some(list.output.clone());
        }
        Ok(pending)
    }

    fn first_step(&self, mut member: Member) -> usize {
        loop {
            match member {
                Member::Step(step) => return step,
                Member::List(list) => match self.lists[list].members.first() {
                    Some(first) => member = *first,
                    None => return 0,
                },
            }
        }
    }
}

impl Step {
    /// The file to write, for data sets of a kind.
    pub fn target(&self, extension: &str) -> PathBuf {
        with_extension(&self.stem, extension)
    }
}

fn read_list(path: &Path) -> Result<Option<Collection>, Failure> {
    Collection::read(path).map_err(|error| Failure::usage(error.to_string()))
}

fn below(above: &str, name: &str) -> String {
    if above.is_empty() { name.to_owned() } else { format!("{above}/{name}") }
}

fn extension(path: &Path) -> String {
    path.extension().map(|extension| extension.to_string_lossy().to_lowercase()).unwrap_or_default()
}

/// A dot in the stem is none before an extension.
fn with_extension(stem: &Path, extension: &str) -> PathBuf {
    let mut name = stem.as_os_str().to_owned();
    name.push(format!(".{extension}"));
    name.into()
}
