"""The words of the report that no number stands in: for somebody who has read none of the documents."""

from __future__ import annotations

from typing import NamedTuple

from wsn_tracking.reproduction import verdicts as v


class Document(NamedTuple):
    """One of the five."""

    title: str
    source: str
    idea: str


DOCUMENTS = {
    'A': Document(
        'Event-triggered sensing, random process noise, covariance intersection',
        'Yang, Zhang, Yu: Acta Automatica Sinica 43(8), 2017',
        'A robot calls every second. Twelve nodes hear how loud it is, and send only what has changed enough. Three '
        'estimators turn loudness into distance and distance into a track with a cubature Kalman filter; each draws '
        'its process noise q, how freely it lets the target move, at random from an interval. They then fuse their '
        'tracks: by covariance intersection (CI), which trusts each by its own covariance; by LCI, which takes '
        'covariances from how far the tracks lie apart; or by the plain mean. EI is the mean of |error in x| + |error '
        'in y|.',
    ),
    'B': Document(
        'Fault-tolerant consensus of cubature information filters',
        'Yang, Shan, Liang, Xu: Control and Decision, 2016',
        'Fifty nodes see distance and direction of a passing target, but each loses its observation at times and then '
        'reads noise. Every node runs its own filter, weighs whether its reading was one at all, and averages what it '
        'learned with its neighbours, round after round, so that without any centre all come to know what a centre '
        'would.',
    ),
    'C': Document(
        'Particle filter for a person whose body shadows the radio',
        'Li, Zhao, Tan: Chinese Journal of Sensors and Actuators 25(6), 2012',
        'A person wears a node; nodes at known places measure how loud it is. The body weakens what comes from '
        'behind, so loudness follows one of two curves. A cloud of particles, guesses of where the person is, is '
        'weighed by how well each explains what was heard. RSS-MCL is the same with one curve for all.',
    ),
    'D': Document(
        'Least squares and Kalman filter combined, several targets',
        'Yu, Xiahou, Ye, Wu: journal article (Chinese), after 2012; its equations are lost',
        'Ultrasonic nodes measure one distance at a time. Least squares (LS) follows a robot at once but is noisy, '
        'the extended Kalman filter (EKF) is smooth but slow when a robot stops dead. The hybrid runs the EKF, and '
        'when ranges no longer fit its prediction, takes the way from there to the least-squares place as its '
        'uncertainty.',
    ),
    'E': Document(
        'Cubature Kalman filter under packet loss',
        'Fang, Chen: Journal of Jinling Institute of Technology 34(1), 2018; the text breaks off before its results',
        'A target turns at unknown rates; sixteen anchors report how loud it is, and any report may be lost. A lost '
        'report is left out of the update. The document says that this filter (CKF) beats extended and unscented ones '
        '(EKF, UKF) at every loss rate.',
    ),
    'X': Document(
        'All five side by side',
        'no document: nobody has compared them',
        'Every system tracks on the same packets, beside one central filter that is told everything and two ways to '
        'place a target without any filter. The table at the end has all recordings.',
    ),
}

ADVICE = (
    (
        'One tracker for signal strengths of a robot',
        'near trigger, iterated update: `trigger.kind=near`, `update.kind=iplf`, `noise.kind=acceleration`',
        'best accuracy for the data sent',
        ('A21', 'A22', 'A23'),
    ),
    (
        'Silence while nothing moves',
        'event trigger, `trigger.kind=event`',
        'the only one that is silent at rest',
        ('A8',),
    ),
    (
        'Several estimators that trust their covariances',
        '`fusion.rule=trace` (CI)',
        'never worse than a cautious local',
        ('A5', 'A6'),
    ),
    ('Locals that are known to be overconfident', '`fusion.rule=lci`', 'CI would lean on the wrong one', ('A4',)),
    (
        'Many nodes, no centre',
        '`consensus` with `scheme: flood`, five rounds',
        'consistent, and fewer bytes than averaging',
        ('B21', 'B22'),
    ),
    (
        'Many nodes, faults of unknown kind',
        '`arrival.loss: uniform`',
        'the zero model loses its track on other faults',
        ('B24',),
    ),
    (
        'A person with a worn node',
        '`human` with profile `improved`',
        'knows the body and that people pause; filters that do not lose the person',
        ('C21', 'X2'),
    ),
    (
        'One robot that most nodes hear',
        'any of them; `loss_tolerant` takes the least time',
        'equally accurate where all are told everything',
        ('X1',),
    ),
    (
        'Robots that stop and go, ranges one by one',
        '`hybrid` with `imm`',
        'quicker after a stop than the hybrid, a little noisier on the way',
        ('D21',),
    ),
    (
        'A radio that loses packets',
        '`loss_tolerant` (CKF)',
        'no worse than the unscented filter, better than the extended one',
        ('E1', 'E21', 'X3'),
    ),
)

SETTING = (
    'By name: `--trackers consensus`; a parameter: `--set update.kind=iplf`, with `./wsn-tracking evaluate BAG` and '
    '`replay BAG`, or in a file that `--config` names. What each means stands in docs/parameters.md.'
)

WORDS = {
    v.REPRODUCED: 'every number and ordering that the document gives is met',
    v.IN_SHAPE: "orderings and signs hold, the numbers differ (or the document's own recording is not published)",
    v.NOT_REPRODUCED: 'what the document says does not hold here',
    v.UNDECIDED: 'more runs would be needed',
    v.NOT_REPRODUCIBLE: 'what is needed to repeat it is not in the document',
    v.HOLDS: 'a statement of this project that holds',
    v.DOES_NOT_HOLD: 'a statement of this project that does not',
}

WHAT = (
    (
        'A wireless sensor network is a set of small radios at known places. From how loud, how far or in which '
        'direction they hear a robot or a person, a filter tells where it is. Five articles say how that should be '
        'done, and print tables, figures and numbers. Here each of these is computed anew from what the articles tell, '
        'and set beside what they print.'
    ),
    (
        'Below are first the count of verdicts, then every claim in one line, then advice on what to use when. After '
        'that each article has its chapter: what it says, and what turned out to be better.'
    ),
)
COMPARED = (
    'The last chapter compares all systems on the same recordings, simulated and, where they were at hand, real ones.'
)

HOW = (
    (
        'Every number is a mean over simulated runs with drawn noise (Monte Carlo), with its 95 % interval: were '
        'everything done again with another seed, about one number in twenty would leave its interval. Variants are '
        'compared run by run over the same draws, so that small differences show. A rule says between which bounds an '
        'interval must lie: one on the shape, for the statement to hold in kind; one on the number, for ours to be the '
        "document's. An interval inside holds, one outside fails, one across is open. A verdict follows from the rules "
        'alone, and from nothing that a person judged afterwards.'
    ),
    (
        'NEES says whether a filter knows its own error: the squared error over the covariance that the filter tells. '
        'Its mean is the number of dimensions (2 for a position) where the filter is honest, and larger where it is '
        'overconfident. RMSE is the root of the mean squared distance to the truth. Best or bound: what a filter would '
        'reach that is linearised at the truth, which none is told (Cramer-Rao).'
    ),
)
