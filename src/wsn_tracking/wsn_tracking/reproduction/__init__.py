"""The five documents computed anew: every table, figure and quantified claim, and what is better than they are."""
