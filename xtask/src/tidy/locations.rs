//! No file names a folder of somebody's machine or a host that only some network knows.

use super::repository::{Finding, Repository};

/// Folders at a file system's root where people keep their own work.
const PRIVATE_FOLDERS: [&str; 4] = ["home", "root", "work", "Users"];

pub fn no_place_of_one_machine(repository: &Repository) -> Vec<Finding> {
    let mut findings = Vec::new();
    for (path, text) in repository.texts() {
        for (index, line) in text.lines().enumerate() {
            if let Some(folder) = PRIVATE_FOLDERS.iter().find(|folder| names_folder(line, folder)) {
                let message = format!("names a path under /{folder}: use one from the root or a variable");
                findings.push(Finding::at(path, index + 1, message));
            }
            if let Some(host) = private_host(line) {
                findings.push(Finding::at(path, index + 1, format!("`{host}` is not a public host")));
            }
        }
    }
    findings
}

/// True when the line has `/folder/` as an absolute path, not inside a longer path or an address.
fn names_folder(line: &str, folder: &str) -> bool {
    let absolute = format!("/{folder}/");
    line.match_indices(&absolute).any(|(start, _)| {
        let before = line[..start].chars().next_back();
        before.is_none_or(|c| !c.is_alphanumeric() && !"_-./}>$~*".contains(c))
    })
}

/// The first host of a web address that a stranger could not reach.
fn private_host(line: &str) -> Option<&str> {
    line.match_indices("://").map(|(start, _)| &line[start + 3..]).find_map(|address| {
        let end = address.find(|c: char| !c.is_ascii_alphanumeric() && c != '.' && c != '-');
        let host = address[..end.unwrap_or(address.len())].trim_end_matches('.');
        (is_private_address(host) || is_private_name(host)).then_some(host)
    })
}

fn is_private_address(host: &str) -> bool {
    host.parse::<std::net::Ipv4Addr>().is_ok_and(|address| address.is_private() || address.is_link_local())
}

fn is_private_name(host: &str) -> bool {
    [".internal", ".local", ".lan", ".corp", ".intranet"].iter().any(|ending| host.ends_with(ending))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn n_findings(line: &str) -> usize {
        no_place_of_one_machine(&Repository::of(&[("README.md", line)])).len()
    }

    #[test]
    fn a_path_of_one_machine_is_found() {
        for folder in PRIVATE_FOLDERS {
            assert_eq!(n_findings(&format!("see `/{folder}/ann/x`")), 1, "{folder}");
            assert_eq!(n_findings(&format!("/{folder}/ann/x")), 1, "{folder}");
            assert_eq!(
                n_findings(&format!("https://example.org/{folder}/ann and a/{folder}/b")),
                0,
                "{folder}"
            );
        }
        assert_eq!(n_findings("/usr/lib and ./target/x"), 0);
    }

    #[test]
    fn a_private_host_is_found() {
        for host in ["10.0.0.7", "192.168.1.2", "mirror.internal"] {
            assert_eq!(n_findings(&format!("index = \"https:{}{host}/simple\"", "//")), 1, "{host}");
        }
        assert_eq!(n_findings("https://crates.io https://{host}/ http://localhost:80/"), 0);
    }
}
