//! The public declarations of Python, generated and our own, one a line, for people to review.

/// The declarations in `source` that programs may use: functions, classes, their methods, fields and cases, each with
/// the names of the classes that it stands in.
///
/// What begins with an underscore is nobody else's.
pub fn declarations(source: &str) -> Vec<String> {
    let mut found: Vec<String> = Vec::new();
    let mut enclosing: Vec<Enclosing> = Vec::new();
    let mut is_text = false;
    let mut lines = source.lines();
    while let Some(line) = lines.next() {
        let mut text = line.trim().to_owned();
        if text.starts_with("def ") {
            // Parameters may take several lines.
            while text.matches('(').count() > text.matches(')').count() {
                let Some(next) = lines.next() else { break };
                text = format!("{text} {}", next.trim());
            }
        }
        let text = text.as_str();
        // Text between triple quotes, whole or its first or last line.
        let n_quotes = text.matches("\"\"\"").count();
        if is_text || n_quotes > 0 {
            is_text ^= n_quotes % 2 == 1;
            continue;
        }
        if text.is_empty() || text.starts_with(['#', '@', ')', ']', '}']) {
            continue;
        }
        let indent = line.len() - line.trim_start().len();
        while enclosing.last().is_some_and(|outer| indent <= outer.indent) {
            enclosing.pop();
        }
        let is_member = enclosing.last().is_none_or(|outer| outer.is_class);
        let is_shown = enclosing.iter().all(|outer| outer.is_shown);
        if let Some(head) = text.strip_prefix("class ") {
            let name = name_of(head);
            let is_shown = is_shown && is_member && is_public(name) && !is_machinery(name);
            if is_shown {
                found.push(listed(&enclosing, &class(name, head)));
            }
            // A class may be bound anew to make its cases its own.
            enclosing.push(Enclosing { indent, name: name.to_owned(), is_class: true, is_shown });
        } else if let Some(head) = text.strip_prefix("def ").or_else(|| text.strip_prefix("async def ")) {
            let name = name_of(head);
            if is_shown && is_member && is_listed(name, enclosing.is_empty()) {
                found.push(listed(&enclosing, &signature(head)));
            }
            enclosing.push(Enclosing { indent, name: name.to_owned(), is_class: false, is_shown: false });
        } else if is_shown && is_member && !enclosing.is_empty() && (is_case(text) || is_field(text)) {
            found.push(listed(&enclosing, text.split(" = ").next().unwrap_or(text)));
        } else if let Some((name, _)) = text.strip_prefix("cls.").and_then(|rest| rest.split_once(" = ")) {
            // A method given to every class whose objects are the engine's.
            if is_public(name) || name == "__enter__" {
                found.push(format!("every object / {name}()"));
            }
        }
    }
    found
}

/// A class or function that others stand in.
struct Enclosing {
    indent: usize,
    name: String,
    is_class: bool,
    is_shown: bool,
}

fn listed(enclosing: &[Enclosing], declaration: &str) -> String {
    let names = enclosing.iter().map(|outer| outer.name.as_str());
    names.chain([declaration]).collect::<Vec<_>>().join(" / ")
}

fn name_of(head: &str) -> &str {
    head.split(|c: char| !c.is_alphanumeric() && c != '_').next().unwrap_or(head)
}

fn is_public(name: &str) -> bool {
    !name.starts_with('_')
}

/// What is needed inside and has a public name.
fn is_machinery(name: &str) -> bool {
    ["InternalError", "make_closable"].contains(&name) || name.ends_with("Protocol")
}

/// The class with those of its bases that a program may know.
fn class(name: &str, head: &str) -> String {
    let bases =
        head.split_once('(').and_then(|(_, rest)| rest.split_once(')')).map_or("", |(bases, _)| bases);
    let is_known = |base: &&str| !base.is_empty() && is_public(base) && !is_machinery(base);
    let bases: Vec<&str> = bases.split(',').map(str::trim).filter(is_known).collect();
    if bases.is_empty() { format!("class {name}") } else { format!("class {name}({})", bases.join(", ")) }
}

/// `NAME = 1`, a case of an enumeration.
fn is_case(text: &str) -> bool {
    let Some((name, _)) = text.split_once(" = ") else { return false };
    !name.is_empty()
        && name.chars().all(|c| c.is_ascii_uppercase() || c.is_ascii_digit() || c == '_')
        && is_public(name)
}

/// `name: type`, a field.
fn is_field(text: &str) -> bool {
    let Some((name, _)) = text.split_once(": ") else { return false };
    is_public(name) && name.chars().all(|c| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_')
}

/// Whether a program may call a function, or a method, of that name.
fn is_listed(name: &str, is_function: bool) -> bool {
    is_public(name) && !is_machinery(name) || name == "__init__" && !is_function
}

/// The head without its colon, without `self`, and with one space where UniFFI prints several.
fn signature(head: &str) -> String {
    let head = head.trim_end().trim_end_matches("pass").trim_end().trim_end_matches(':');
    let spaced = head.replace(',', ", ");
    let words: Vec<&str> = spaced.split_whitespace().collect();
    let mut head = words.join(" ");
    for (printed, plain) in [
        ("(self, ", "("),
        ("(self,)", "()"),
        ("(self)", "()"),
        ("(cls, ", "("),
        ("(cls,)", "()"),
        (", )", ")"),
        (",)", ")"),
        ("( ", "("),
    ] {
        head = head.replace(printed, plain);
    }
    head
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn programs_see_public_declarations_and_no_machinery() {
        let source = "\
class _UniffiHelper:
    def hidden(self):
        pass

class FixMode(enum.Enum):
    \"\"\"
    What a fix rests on.
    SHOUTED = in a text
    \"\"\"
    STARTED = 0
    \"\"\"A start.\"\"\"

    STALE = 2

@dataclass
class Fix:
    def __init__(self, *, time_ns:int, mode:FixMode):
        self.time_ns = time_ns
    def __str__(self):
        return \"Fix()\"

class PositionerProtocol(typing.Protocol):
    def fix(self, ) -> typing.Optional[Fix]:
        ...

class ApiError(Exception):
    pass

class ApiError:  # type: ignore
    class Broken(_UniffiTempApiError):
        def __init__(self, explanation, remedy):
            pass

class Positioner(PositionerProtocol):
    _handle: ctypes.c_uint64
    @classmethod
    def restored(cls, snapshot: bytes,seed: int) -> Positioner:
        def inner():
            pass
        return None
    def __del__(self):
        pass
    def fix(self, ) -> typing.Optional[Fix]:
        return None

def version() -> str:
    return \"\"
@dataclass(frozen=True)
class Replayed:
    \"\"\"What a replay gave.\"\"\"

    #: The fixes.
    fixes: list[Fix]
    @property
    def median_error_m(self) -> float:
        known: int = 1

def replay(
    building: BuildingMap,
    *,
    start: Optional[tuple[float, float]] = None,
) -> Replayed:
    \"\"\"Replays.\"\"\"
def make_closable(cls: type) -> None:
    def close(self) -> None:
        pass
    cls.close = close
    cls._hidden = close
    cls.__enter__ = lambda self: self
def _hidden() -> None:
    pass
";
        assert_eq!(
            declarations(source),
            [
                "class FixMode(enum.Enum)",
                "FixMode / STARTED",
                "FixMode / STALE",
                "class Fix",
                "Fix / __init__(*, time_ns:int, mode:FixMode)",
                "class ApiError(Exception)",
                "class ApiError",
                "ApiError / class Broken",
                "ApiError / Broken / __init__(explanation, remedy)",
                "class Positioner",
                "Positioner / restored(snapshot: bytes, seed: int) -> Positioner",
                "Positioner / fix() -> typing.Optional[Fix]",
                "version() -> str",
                "class Replayed",
                "Replayed / fixes: list[Fix]",
                "Replayed / median_error_m() -> float",
                "replay(building: BuildingMap, *, start: Optional[tuple[float, float]] = None) -> Replayed",
                "every object / close()",
                "every object / __enter__()",
            ]
        );
    }
}
