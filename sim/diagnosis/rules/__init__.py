"""All rules, in the order in which their findings are listed: those that stop a program come first."""

from sim.diagnosis.rule import Rule
from sim.diagnosis.rules.actions import CancelIgnored, GoalNeverExecuted
from sim.diagnosis.rules.clocks import AlwaysDue, ClockNeverStarts, TimesKept, TriggersItself
from sim.diagnosis.rules.deadlock import NeedsOneMoreWorker, SelfMadeDeadlock
from sim.diagnosis.rules.endless import EndlessWait, StaysInLoop, StillComputing
from sim.diagnosis.rules.errors import (
    ExceptionCaught,
    ExceptionSwallowed,
    ProgramRaised,
    SpinRaised,
    ThreadRaised,
)
from sim.diagnosis.rules.feedback import FeedbackLoop
from sim.diagnosis.rules.incomplete import GapsInTrace
from sim.diagnosis.rules.leaks import NeverDestroyed
from sim.diagnosis.rules.locks import LockHeldLong, LocksInTurn
from sim.diagnosis.rules.messages import DroppedMessages, QosMismatch, SentTooEarly, StaleData
from sim.diagnosis.rules.names import MisspeltTopic
from sim.diagnosis.rules.overlooked import AnswerOverlooked, Slip
from sim.diagnosis.rules.parameters import DeadlockOverParameter, ParameterOverruled
from sim.diagnosis.rules.services import (
    NobodyOffers,
    ServiceFallsBehind,
    ServiceNeverComes,
    UnreturnedResponse,
    WaitedInVain,
)
from sim.diagnosis.rules.spinning import (
    AsyncioStarved,
    NestedSpin,
    SpinInConstructor,
    SpinNotReached,
)
from sim.diagnosis.rules.synchronisers import NeverSynchronised
from sim.diagnosis.rules.threads import GroupsChangeNothing, ThreadsNeverUsed
from sim.diagnosis.rules.timing import (
    FallsBehind,
    MeantInMilliseconds,
    OverlappingCallback,
    Overload,
    OverrunTimer,
)
from sim.diagnosis.rules.transforms import LookupKeepsTransform
from sim.diagnosis.rules.unended import ReplyAwaitsInVain, ThreadWaitsForNobody, WaitsForLock
from sim.diagnosis.rules.unspun import NodeNeverSpins, SpinPastExecutor, SpinsTooRarely
from sim.diagnosis.rules.waiting import BehindOthers, GroupStarvation, NoFreeWorker

RULES: tuple[Rule, ...] = (
    SelfMadeDeadlock(),
    NeedsOneMoreWorker(),
    DeadlockOverParameter(),
    NestedSpin(),
    SpinInConstructor(),
    SpinNotReached(),
    SpinPastExecutor(),
    AsyncioStarved(),
    AlwaysDue(),
    TriggersItself(),
    ClockNeverStarts(),
    StillComputing(),
    EndlessWait(),
    WaitsForLock(),
    ServiceNeverComes(),
    StaysInLoop(),
    ProgramRaised(),
    SpinRaised(),
    ThreadRaised(),
    NodeNeverSpins(),
    SpinsTooRarely(),
    NobodyOffers(),
    WaitedInVain(),
    QosMismatch(),
    MisspeltTopic(),
    SentTooEarly(),
    NeverSynchronised(),
    FeedbackLoop(),
    TimesKept(),
    ParameterOverruled(),
    Slip(),
    AnswerOverlooked(),
    ExceptionSwallowed(),
    ExceptionCaught(),
    UnreturnedResponse(),
    ReplyAwaitsInVain(),
    CancelIgnored(),
    GoalNeverExecuted(),
    NeverDestroyed(),
    LookupKeepsTransform(),
    LockHeldLong(),
    GroupStarvation(),
    NoFreeWorker(),
    BehindOthers(),
    OverlappingCallback(),
    OverrunTimer(),
    Overload(),
    FallsBehind(),
    ServiceFallsBehind(),
    StaleData(),
    DroppedMessages(),
    ThreadWaitsForNobody(),
    LocksInTurn(),
    GapsInTrace(),
    MeantInMilliseconds(),
    GroupsChangeNothing(),
    ThreadsNeverUsed(),
)
