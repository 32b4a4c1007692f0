"""Which systems track on a feed, and by which configuration each."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from wsn_tracking.configuration import Configuration, configuration_names, load_configuration
from wsn_tracking.errors import TrackingError
from wsn_tracking.graphs.consensus import CONSENSUS, plan_consensus
from wsn_tracking.graphs.facts import facts_of, told
from wsn_tracking.graphs.parts import Plan, Source
from wsn_tracking.graphs.random_q import RANDOM_Q, plan_random_q
from wsn_tracking.graphs.single import CONFIGS, plan_single
from wsn_tracking.models.anchors import Anchors
from wsn_tracking.parameters import Values

SYSTEMS = (RANDOM_Q, CONSENSUS, *CONFIGS)
ALL = 'all'
SECTIONS: Mapping[str, tuple[str, ...]] = {  # of a configuration file: the nodes of each system
    RANDOM_Q: ('sensing*', 'estimator*'),
    CONSENSUS: ('consensus_node',),
    **{system: (f'{system}_tracker', f'{system}_tracker_node') for system in CONFIGS},
}


def system_of(configuration: str) -> str:
    """The system that a configuration is for, by its name: that begins with it, or is of random_q."""
    stem = Path(configuration).stem
    return next((s for s in SYSTEMS if stem == s or stem.startswith(f'{s}_')), RANDOM_Q)


def systems_of(source: Source, trackers: str = '', configuration: str = '') -> tuple[str, ...]:
    """The systems in `trackers`, a comma between them; `all` is every one; empty: the one that the feed is for.

    That is the system of the configuration, or of the one that the feed names; bearings are for consensus.
    """
    if trackers == ALL:
        return SYSTEMS
    if not trackers:
        named = configuration or source.metadata.get('configuration', '')
        return (CONSENSUS if source.entry_level == 'observation' and not configuration else system_of(named),)
    asked = tuple(dict.fromkeys(trackers.split(',')))
    for system in asked:
        if system not in SYSTEMS:
            raise TrackingError(f'there is no system `{system}`: expected some of {", ".join(SYSTEMS)}, or {ALL}')
    return asked


def configuration_of(system: str, source: Source) -> str:
    """The configuration of a system for a feed.

    It is the one that the feed names, if of that system; else <system>_<that name>, or with fewer of the name's words,
    if there is one; else <system>.
    """
    named = source.metadata.get('configuration', '')
    if named and system_of(named) == system and (system != RANDOM_Q or named in configuration_names()):
        return named
    known, words = configuration_names(), named.split('_')
    special = ['_'.join([system, *words[:count]]) for count in range(len(words), 0, -1)]
    return next((name for name in special if name in known), system)


def is_made_for(configuration: str, system: str, source: Source) -> bool:
    """Whether a configuration of a system is for this feed; that of a document is for the feeds that name it."""
    return configuration != system or source.metadata.get('configuration') == system


def plans_of(
    source: Source,
    anchors: Anchors,
    trackers: str = '',
    configuration: Configuration | str = '',
    settings: Values | None = None,
    target_id: int = -1,
) -> tuple[Plan, ...]:
    """The plan of each system (see `systems_of`).

    A configuration of this package is for its own system, a file of the user's for all of them, each of which takes the
    sections of its own nodes. Without one, a system
    for which the feed has none of its own is told what follows from the field (see `facts`).
    """
    name = configuration if isinstance(configuration, str) else ''
    systems = systems_of(source, trackers, name)
    if name in configuration_names() and system_of(name) not in systems:
        raise TrackingError(f'configuration `{name}` is of system {system_of(name)}, not of {", ".join(systems)}')
    plans: list[Plan] = []
    for system in systems:
        is_of_another = name in configuration_names() and system_of(name) != system
        chosen, given = '' if is_of_another else configuration, dict(settings or {})
        if isinstance(chosen, str):
            own = chosen or configuration_of(system, source)
            if not (chosen or is_made_for(own, system, source)):
                given = {**told(system, source, anchors, facts_of(source, anchors)), **given}
            chosen = load_configuration(own)
        try:
            plans.append(_plan_of(system, source, anchors, _for(system, chosen), given, target_id))
        except TrackingError as error:
            if len(systems) == 1:
                raise
            raise TrackingError(f'system {system}: {error}') from error
    return tuple(plans)


def _for(system: str, configuration: Configuration) -> Configuration:
    """Without the sections of other systems' nodes: one file may serve several."""
    return configuration.but(*(name for other, names in SECTIONS.items() if other != system for name in names))


def _plan_of(
    system: str, source: Source, anchors: Anchors, configuration: Configuration, settings: Values, target_id: int
) -> Plan:
    if system == RANDOM_Q:
        return plan_random_q(source, configuration, settings, target_id)
    if system == CONSENSUS:
        return plan_consensus(source, anchors, configuration, settings, target_id)
    return plan_single(system, source, configuration, settings, target_id)
