//! Writes `docs/simulator/`: statistics of simulated recordings beside those of real ones, as a page with pictures.
//!
//! ```sh
//! FIELDWALK_DATA=… cargo run --release -p fieldwalk-tests --bin simulator_page [OUT]
//! ```
//! Only statistics are written, never a record.

mod field;
mod gait;
mod held;
mod motion;
mod page;
mod radio;
mod spread;

use std::error::Error;
use std::path::PathBuf;

fn main() -> Result<(), Box<dyn Error>> {
    let out = std::env::args_os().nth(1).map_or_else(|| PathBuf::from("docs/simulator"), PathBuf::from);
    let mut page = page::Page::new(&out)?;
    gait::write(&mut page)?;
    held::write(&mut page)?;
    radio::write(&mut page)?;
    field::write(&mut page)?;
    page.finish()?;
    println!("{}", out.join("README.md").display());
    Ok(())
}
