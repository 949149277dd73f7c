//! The page: headings, text, tables, pictures.

use std::fmt::Write as _;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

const HEAD: &str = "\
# The simulator beside real recordings

Statistics of what `fieldwalk-sim` makes beside the same statistics of recordings by others, computed by the same code. The
simulator's parameters are physical; where this page showed them off from reality they were repaired, never to any
positioning result. Numbers are medians, in brackets where four fifths of the values lie; boxes hold half of them.

Regenerate with `FIELDWALK_DATA=… cargo run --release -p fieldwalk-tests --bin simulator_page`. `NOTICE` says where the
recordings come from and under which licences: Oxford Step Counter data set (CC BY 4.0; Salvi 2018), On Attitude
Estimation with Smartphones (CeCILL 2.1; Michel et al. 2017), Position-Annotated BLE RSSI Dataset (CC0; Daniş et al.
2022), indoor-location-competition-20 (MIT). Nothing here is a record of theirs: all are statistics.
";

pub struct Page {
    out: PathBuf,
    text: String,
}

impl Page {
    pub fn new(out: &Path) -> io::Result<Self> {
        fs::create_dir_all(out)?;
        Ok(Self { out: out.to_owned(), text: HEAD.into() })
    }

    pub fn heading(&mut self, heading: &str) {
        let _ = write!(self.text, "\n## {heading}\n");
    }

    pub fn say(&mut self, paragraph: &str) {
        let _ = write!(self.text, "\n{paragraph}\n");
    }

    /// A table; the first row is its head.
    pub fn table(&mut self, rows: &[Vec<String>]) {
        self.text.push('\n');
        for (k, row) in rows.iter().enumerate() {
            let _ = writeln!(self.text, "| {} |", row.join(" | "));
            if k == 0 {
                let _ = writeln!(self.text, "|{}", "---|".repeat(row.len()));
            }
        }
    }

    pub fn picture(&mut self, name: &str, alt: &str, svg: &str) -> io::Result<()> {
        fs::write(self.out.join(format!("{name}.svg")), svg)?;
        let _ = write!(self.text, "\n![{alt}]({name}.svg)\n");
        Ok(())
    }

    pub fn finish(self) -> io::Result<()> {
        fs::write(self.out.join("README.md"), self.text)
    }
}
