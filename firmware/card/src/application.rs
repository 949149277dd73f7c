//! The application: one round after the other.

use fieldwalk_codec::{CardFlags, CardFrame, CardHeader, CardRepr, battery_from_mv};

use crate::battery::{BatteryMonitor, Charge};
use crate::calibration::Calibration;
use crate::hardware::{Advertiser, Board, Clock, Hardware, MotionSensor, Retained as _, Supply, Watchdog};
use crate::level::low_pass_factor;
use crate::pace::{LOOKS, LOOKS_A_THIRD, Pace};
use crate::round::RoundBuilder;
use crate::sequence::SequenceCounter;
use crate::stillness::StillnessDetector;
use crate::store::CalibrationStore;
use crate::swing::SwingWatch;

/// Most accelerations of a round: what the KMX62's buffer of 384 bytes holds.
const MAX_READINGS: usize = 64;
/// Rounds after which the battery is measured again.
const BATTERY_ROUNDS: u32 = 60;
/// Rounds without a reading after which the watchdog is no longer fed: restarting the sensor alone does not help.
const MAX_FAULTS: u16 = 30;
/// Longest that a card sleeps at a time, in seconds: less than the watchdog waits.
const NAP_S: u32 = 30;
/// How long an exhausted card stays silent until its battery is measured again, in seconds.
const EXHAUSTED_S: u64 = 600;

/// What a card is tuned to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CardParams {
    /// The card's identifier, which its frames tell.
    pub card_id: u16,
    /// Readings of the accelerometer a second; default 25, which the KMX62 has, for the paper's 15, which it has not: at
    /// 12.5 extremes of steps fall between readings.
    pub reading_hz: f32,
    /// Cut-off of gravity's low-pass, in Hz; default 0.3: half of the slowest walk's frequency, so that steps do not tilt
    /// the vertical, and a card that turns on its strap is upright again within seconds.
    pub gravity_cutoff_hz: f32,
    /// A round in which `|acc|` varies by less is still, in m/s²; default 0.4: twenty times the sensor's noise.
    pub still_m_s2: f32,
    /// Still rounds after which the card sleeps; default 60.
    pub still_rounds: u16,
}

impl CardParams {
    /// The card with that identifier, as tuned by default.
    pub fn of_card(card_id: u16) -> Self {
        Self { card_id, reading_hz: 25.0, gravity_cutoff_hz: 0.3, still_m_s2: 0.4, still_rounds: 60 }
    }
}

/// What a round came to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RoundOutcome {
    /// This frame was sent.
    Sent([u8; CardRepr::BUFFER_LEN]),
    /// The card slept, and has been moved.
    Slept,
    /// The battery is exhausted: nothing was sent.
    Silent,
}

/// A card.
#[expect(missing_debug_implementations, reason = "parts are registers, which are not printed")]
pub struct Card<H: Hardware> {
    board: Board<H>,
    params: CardParams,
    builder: RoundBuilder,
    forces_m_s2: [[f32; 3]; MAX_READINGS],
    calibration: Option<Calibration>,
    swing: SwingWatch,
    stillness: StillnessDetector,
    battery: BatteryMonitor,
    sequence: SequenceCounter,
    pace: Pace,
    just_woke: bool,
    n_rounds: u32,
    n_faults: u16,
}

impl<H: Hardware> Card<H> {
    /// Switches a card on: loads its calibration, takes up its sequence, starts its sensor. One that does not start is
    /// tried again each round.
    pub async fn new(mut board: Board<H>, params: CardParams) -> Self {
        // Without a readable record the card is uncalibrated, and its frames say so.
        let calibration = CalibrationStore::new(&mut board.flash).load().ok().flatten();
        let sequence = SequenceCounter::resumed(&board.retained);
        let n_faults = u16::from(board.sensor.start().await.is_err());
        let seed = u32::from(params.card_id) ^ board.retained.load().rotate_left(16);
        let smoothing = low_pass_factor(params.gravity_cutoff_hz, 1.0 / params.reading_hz);
        Self {
            builder: RoundBuilder::new(smoothing),
            forces_m_s2: [[0.0; 3]; MAX_READINGS],
            calibration,
            swing: SwingWatch::default(),
            stillness: StillnessDetector::new(params.still_m_s2, params.still_rounds),
            battery: BatteryMonitor::default(),
            sequence,
            pace: Pace::new(board.clock.now_us(), seed),
            just_woke: true,
            n_rounds: 0,
            n_faults,
            board,
            params,
        }
    }

    /// Runs for ever.
    pub async fn run(&mut self) -> ! {
        loop {
            self.round().await;
        }
    }

    /// One round: looks at the field, waits for its end, takes the accelerations, sends a frame; sleeps where it is time to.
    pub async fn round(&mut self) -> RoundOutcome {
        let mut fields_ut = [None; LOOKS];
        for (look, field_ut) in fields_ut.iter_mut().enumerate() {
            self.board.clock.wait_until_us(self.pace.look_us(look)).await;
            *field_ut = self.board.sensor.field_ut().await.ok();
        }
        self.board.clock.wait_until_us(self.pace.next_us()).await;
        if self.n_rounds.is_multiple_of(BATTERY_ROUNDS) {
            let voltage_mv = self.board.supply.voltage_mv().await;
            if self.battery.push(voltage_mv) == Charge::Exhausted {
                self.stay_silent().await;
                return RoundOutcome::Silent;
            }
        }
        self.n_rounds = self.n_rounds.wrapping_add(1);
        self.read(fields_ut).await;
        let swing_m_s2 = self.builder.swing_m_s2();
        let frame = self.frame();
        self.board.advertiser.advertise(&frame).await;
        self.just_woke = false;
        if self.n_faults < MAX_FAULTS {
            self.board.watchdog.feed();
        }
        self.end_swing();
        self.pace.advance(self.board.clock.now_us());
        if self.stillness.push(swing_m_s2) && !self.swing.is_open() && self.sleep().await {
            return RoundOutcome::Slept;
        }
        RoundOutcome::Sent(frame)
    }

    /// The board, as for a look at its parts after some rounds.
    pub fn board(&self) -> &Board<H> {
        &self.board
    }

    /// The calibration in force.
    pub fn calibration(&self) -> Option<&Calibration> {
        self.calibration.as_ref()
    }

    /// Takes the accelerations of the open round, and what looks at the field have found. A swing is told of three a second.
    async fn read(&mut self, fields_ut: [Option<[f32; 3]>; LOOKS]) {
        let n = match self.board.sensor.drain(&mut self.forces_m_s2).await {
            Ok(n) if n > 0 => n.min(MAX_READINGS),
            // A sensor that says nothing hangs, or was reset by a dip of the supply.
            _ => {
                self.n_faults = self.n_faults.saturating_add(1);
                self.builder.restart();
                let _ = self.board.sensor.start().await; // tried again next round
                return;
            }
        };
        self.n_faults = 0;
        let mut fields_ut = fields_ut.into_iter().enumerate().peekable();
        for (k, force_m_s2) in self.forces_m_s2[..n].iter().enumerate() {
            self.builder.push_force(3 * k / n, *force_m_s2);
            // By the gravity of its time.
            let is_due = |(look, _): &(usize, _)| 2 * LOOKS * (k + 1) > (2 * look + 1) * n;
            while let Some((look, found_ut)) = fields_ut.next_if(is_due) {
                let Some(raw_ut) = found_ut else { continue };
                if look % LOOKS_A_THIRD == 0
                    && let Some(gravity_m_s2) = self.builder.gravity_m_s2()
                {
                    self.swing.push(raw_ut, gravity_m_s2);
                }
                let field_ut = self.calibration.map_or(raw_ut, |calibration| calibration.apply(raw_ut));
                self.builder.push_field(look / LOOKS_A_THIRD, field_ut);
            }
        }
    }

    /// Closes the round into a frame.
    fn frame(&mut self) -> [u8; CardRepr::BUFFER_LEN] {
        let flags = CardFlags {
            calibrated: self.calibration.is_some(),
            just_woke: self.just_woke,
            low_battery: self.battery.charge() != Charge::Good,
            motion_missing: false, // the codec's to say
        };
        let header = CardHeader {
            flags,
            battery: self.battery.voltage_mv().map_or(0, battery_from_mv),
            sequence: self.sequence.take(&mut self.board.retained),
            card_id: self.params.card_id,
        };
        let mut frame = [0; CardRepr::BUFFER_LEN];
        CardRepr::from_physical(header, &self.builder.close())
            .emit(&mut CardFrame::new_unchecked(&mut frame));
        frame
    }

    /// Keeps what a swing gave that has ended. One that was poor leaves the calibration that there is.
    fn end_swing(&mut self) {
        if let Some(Ok(calibration)) = self.swing.end_round() {
            self.calibration = Some(calibration);
            // Where it cannot be kept, it holds until the next reset.
            let _ = CalibrationStore::new(&mut self.board.flash).save(&calibration);
        }
    }

    /// Sleeps until the card is moved; whether it did, for a sensor may refuse to watch.
    async fn sleep(&mut self) -> bool {
        self.stillness.restart();
        if self.board.sensor.arm().await.is_err() {
            let _ = self.board.sensor.start().await; // tried again next round
            return false;
        }
        loop {
            self.board.watchdog.feed();
            match self.board.sensor.wait_for_motion(NAP_S).await {
                Ok(false) => {}
                // A sensor that fails is no longer asleep either.
                Ok(true) | Err(_) => break,
            }
        }
        self.wake().await;
        true
    }

    /// Sends nothing and reads nothing for a while.
    async fn stay_silent(&mut self) {
        let _ = self.board.sensor.arm().await; // it draws more if this fails, and there is nothing else to do
        let until_us = self.board.clock.now_us() + 1_000_000 * EXHAUSTED_S;
        while self.board.clock.now_us() < until_us {
            self.board.watchdog.feed();
            let nap_us = self.board.clock.now_us() + 1_000_000 * u64::from(NAP_S);
            self.board.clock.wait_until_us(nap_us.min(until_us)).await;
        }
        self.wake().await;
    }

    /// Begins anew after a gap.
    async fn wake(&mut self) {
        let _ = self.board.sensor.start().await; // tried again next round
        self.builder.restart();
        self.sequence.interrupt(&mut self.board.retained);
        self.just_woke = true;
        self.n_rounds = 0;
        self.pace.restart(self.board.clock.now_us());
    }
}
