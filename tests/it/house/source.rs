//! Just enough of a Rust tokenizer to read paths out of sources: comments and literals vanish.

use std::path::{Path, PathBuf};

/// A source file of the project, without comments, literals and `#[cfg(test)]` items.
pub struct Source {
    /// Path below `src`, such as `plot/picture.rs`.
    pub path: PathBuf,
    /// Identifiers, `::` as one token, every other character as its own.
    pub tokens: Vec<String>,
}

impl Source {
    pub fn read(root: &Path, file: &Path) -> Self {
        let text = std::fs::read_to_string(file).unwrap();
        Self { path: file.strip_prefix(root).unwrap().to_path_buf(), tokens: without_tests(tokens(&text)) }
    }

    /// The module that the file belongs to: the first folder or file below `src`.
    pub fn module(&self) -> String {
        let first = self.path.iter().next().unwrap().to_str().unwrap();
        first.strip_suffix(".rs").unwrap_or(first).to_owned()
    }

    /// First segments of all paths that start with `root`, groups in braces opened: `root::{a::x, b}` gives a and b.
    pub fn heads_after(&self, root: &str) -> Vec<String> {
        let mut heads = Vec::new();
        for (at, token) in self.tokens.iter().enumerate() {
            if token != root || self.token(at + 1) != "::" || (at > 0 && self.token(at - 1) == "::") {
                continue;
            }
            if self.token(at + 2) != "{" {
                heads.push(self.token(at + 2).to_owned());
                continue;
            }
            let mut depth = 0;
            for inner in at + 2..self.tokens.len() {
                match self.token(inner) {
                    "{" => depth += 1,
                    "}" => depth -= 1,
                    _ => (),
                }
                if depth == 0 {
                    break;
                }
                if depth == 1 && matches!(self.token(inner), "{" | ",") && self.token(inner + 1) != "}" {
                    heads.push(self.token(inner + 1).to_owned());
                }
            }
        }
        heads
    }

    /// Whether a path starts with the outside crate `name`.
    pub fn names_crate(&self, name: &str) -> bool {
        (0..self.tokens.len()).any(|at| {
            let before = if at == 0 { "" } else { self.token(at - 1) };
            let is_use = before == "use" && matches!(self.token(at + 1), ";" | "as");
            self.token(at) == name && before != "." && (is_use || self.token(at + 1) == "::" && self.is_head(at))
        })
    }

    /// Longest chain of `super::super::...`.
    pub fn longest_super_chain(&self) -> usize {
        let mut longest = 0;
        for at in 0..self.tokens.len() {
            let chain = (0..).take_while(|k| self.token(at + 2 * k) == "super" && self.token(at + 2 * k + 1) == "::");
            longest = longest.max(chain.count());
        }
        longest
    }

    /// Whether the tokens hold `wanted` in a row.
    pub fn has(&self, wanted: &[&str]) -> bool {
        self.tokens.windows(wanted.len()).any(|window| window.iter().zip(wanted).all(|(a, b)| a == b))
    }

    /// `::name` at the start of a path is an outside crate, `a::name` is not.
    fn is_head(&self, at: usize) -> bool {
        at == 0 || self.token(at - 1) != "::" || at == 1 || !is_word(self.token(at - 2))
    }

    fn token(&self, at: usize) -> &str {
        self.tokens.get(at).map_or("", String::as_str)
    }
}

fn is_word(token: &str) -> bool {
    token.starts_with(|c: char| c.is_alphanumeric() || c == '_') || token == ">"
}

pub fn tokens(text: &str) -> Vec<String> {
    let chars: Vec<char> = text.chars().collect();
    let get = |at: usize| chars.get(at).copied().unwrap_or('\0');
    let (mut tokens, mut at) = (Vec::new(), 0);
    while at < chars.len() {
        match (get(at), get(at + 1)) {
            ('/', '/') => {
                while at < chars.len() && get(at) != '\n' {
                    at += 1;
                }
            }
            ('/', '*') => {
                at += 2;
                while at < chars.len() && (get(at), get(at + 1)) != ('*', '/') {
                    at += 1;
                }
                at += 2;
            }
            ('"', _) => at = after_string(&chars, at),
            ('r', '"' | '#') if raw_hashes(&chars, at).is_some() => {
                let hashes = raw_hashes(&chars, at).unwrap();
                let end: Vec<char> = std::iter::once('"').chain(std::iter::repeat_n('#', hashes)).collect();
                at += hashes + 2;
                while at < chars.len() && !chars[at..].starts_with(&end) {
                    at += 1;
                }
                at += end.len();
            }
            // A lifetime has no closing quote; a character literal closes after one character or an escape.
            ('\'', '\\') => {
                at += 3;
                while at < chars.len() && get(at) != '\'' {
                    at += 1;
                }
                at += 1;
            }
            ('\'', _) => at += if get(at + 2) == '\'' { 3 } else { 1 },
            (':', ':') => {
                tokens.push("::".to_owned());
                at += 2;
            }
            (c, _) if c.is_alphanumeric() || c == '_' => {
                let start = at;
                while get(at).is_alphanumeric() || get(at) == '_' {
                    at += 1;
                }
                tokens.push(chars[start..at].iter().collect());
            }
            (c, _) => {
                if !c.is_whitespace() {
                    tokens.push(c.to_string());
                }
                at += 1;
            }
        }
    }
    tokens
}

fn raw_hashes(chars: &[char], at: usize) -> Option<usize> {
    let hashes = chars[at + 1..].iter().take_while(|&&c| c == '#').count();
    (chars.get(at + 1 + hashes) == Some(&'"')).then_some(hashes)
}

fn after_string(chars: &[char], mut at: usize) -> usize {
    at += 1;
    while at < chars.len() && chars[at] != '"' {
        at += if chars[at] == '\\' { 2 } else { 1 };
    }
    at + 1
}

/// Drops each item after `#[cfg(test)]`, to its `;` or closing brace.
fn without_tests(tokens: Vec<String>) -> Vec<String> {
    let mark = ["#", "[", "cfg", "(", "test", ")", "]"];
    let (mut kept, mut at) = (Vec::new(), 0);
    while at < tokens.len() {
        if !tokens[at..].iter().take(mark.len()).eq(mark.iter()) {
            kept.push(tokens[at].clone());
            at += 1;
            continue;
        }
        at += mark.len();
        let mut depth = 0;
        while at < tokens.len() {
            match tokens[at].as_str() {
                "{" => depth += 1,
                "}" => depth -= 1,
                _ => (),
            }
            at += 1;
            if depth == 0 && matches!(tokens[at - 1].as_str(), "}" | ";") {
                break;
            }
        }
    }
    kept
}
